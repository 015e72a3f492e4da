// Recordings of the DFKI data set of unexploded ordnance, as published (zenodo.org/records/11068046): an ARIS
// Explorer 3000 on a robot arm on a gantry above a test basin. A folder `recordings/<target>/<recording>`:
//
//   aris_raw/NNNN.pgm    a frame of SamplesPerBeam rows x beams columns, row 0 nearest, beams from right to
//                        left; NNNN is its FrameIndex
//   aris_frame_meta.csv  the header of each frame, with the names of data_io/sonars/aris_io.h, FrameTime in
//                        microseconds
//   ar3.csv              aris_frame_idx, pos.x, pos.y, pos.z (m), rot.x, rot.y, rot.z, rot.w: world_from_arm
//   gantry.csv           aris_frame_idx, x, y, z (m): the gantry, which carries the arm
//
// and three folders up calibration/transforms.yaml (data_io/sonars/frame_tree.h) and 3d_models/. A frame's
// pose is that of ar3.csv, then the chain from setup/ar3 to setup/sonar, whose axes are X right, Y down, Z
// forward, like those of its camera: with these axes the published poses look at their targets with Z up. If
// ar3.csv or the chain is missing, frames have no pose, with a note. gantry.csv is only compared with it.
// Polar pictures and photographs are not read.
//
// Source: github.com/dfki-ric/uxo-dataset2024, the scripts that export the data set. Tested only with a
// synthetic copy.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// True for a folder with aris_frame_meta.csv and aris_raw.
bool IsDfkiUxo(const std::filesystem::path& path);

// Reads the tables, and pictures on request. Throws DataError with file and line if a table is damaged, or no
// frame of it has a picture.
std::unique_ptr<RecordingSource> OpenDfkiUxo(const std::filesystem::path& path);

}  // namespace sonarcal::data_io
