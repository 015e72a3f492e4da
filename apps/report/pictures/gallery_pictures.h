// The pictures of a scene from its viewpoints: depth, fan and polar image of each, and all of them in one.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "core/types/rgb_image.h"
#include "sim/simulator.h"

namespace sonarcal::report {

// What a sonar sees from one place.
struct GalleryView {
  Grid<float> depth_m;  // range along the rays of a pinhole grid of square pixels, 0 for nothing
  PolarImage image;
};

// The depth image is as wide as `depth_cols`, and as high as the elevation beam width makes it.
GalleryView SeeView(const sim::Simulator& simulator, const Pose& world_from_sonar,
                    const ParameterSet& parameters, int frame_idx, int depth_cols = 360);

struct GalleryPictures {
  RgbImage depth;
  RgbImage fan;
  RgbImage polar;
};

// The grey level that the brightest colour stands for in all views of a scene: 99.5 % of the pixels that are
// not 0 lie below. So faint scenes are seen too, and views of one scene can be compared.
double BrightestGrey(const std::vector<GalleryView>& views);

// Depth: near is bright, white is nothing. Fan and polar: colour by the square root of the grey level, for
// faint beds and bright walls at once. Fan: ahead is up. Polar: nearest range at the top, leftmost beam
// at the left, as in the pictures of other commands.
GalleryPictures MakePictures(const GalleryView& view, double brightest_grey);

// A row for each view: depth, fan, polar; on white.
RgbImage Sheet(const std::vector<GalleryPictures>& rows);

}  // namespace sonarcal::report
