// What is known beforehand of the frames of a bomb that an ARIS 3000 recorded
// (data_io/sonars/aris3000_frames_io.h), for fits of the acoustic model to them: docs/studies/bomb.md.
//
// Outline (sim/scenes/bomb.h) and poses were found once by least squares of images, on frame 0 and on the
// other pose alone, and are held where the model is fitted: about them the likelihood trades the wrong
// outline for worse images. Frame 1 shows the same still scene as frame 0.
#pragma once

#include "calib/poses/target_pose.h"
#include "calib/target_fit.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "data_io/pictures/fan_geometry.h"

namespace sonarcal::calib {

TargetPose BombPose();       // of frames 0 and 1
TargetPose BombOtherPose();  // of other_pose_fan.png; from here its fit starts

// Fan of other_pose_fan.png: apex and arcs as given in the README of the recording.
data_io::FanGeometry BombOtherPoseFan();

// Where the fit starts: a beam and a pulse as the grain shows them. `display` as read off the background
// (calib/noise/background_display.h), on which the noise is 0 dB.
ParameterSet BombInitial(const DisplayParameters<double>& display, const SonarModel& sonar);

// Of the model, at the pose given.
TargetFitOptions BombFitOptions();

}  // namespace sonarcal::calib
