// Pictures of a scene from its viewpoints: depth, fan and polar image of each, and all of them on one sheet.
#pragma once

#include <vector>

#include "core/types/image.h"
#include "core/types/rgb_image.h"
#include "sim/simulator.h"

namespace sonarcal::report {

// Images of a sonar at one pose.
struct GalleryView {
  Grid<float> depth_m;  // range along the rays of a pinhole grid with square pixels, 0 for nothing
  PolarImage image;
};

// The depth image has `depth_cols` columns, and the height that the elevation beam width gives.
GalleryView SeeView(const sim::Simulator& simulator, const Pose& world_from_sonar,
                    const ParameterSet& parameters, int frame_idx, int depth_cols = 360);

struct GalleryPictures {
  RgbImage depth;
  RgbImage fan;
  RgbImage polar;
};

// Returns the grey level of the brightest colour in all views of a scene: 99.5 % of the non-zero pixels are
// below it. Faint scenes stay visible, and views of one scene can be compared.
double BrightestGrey(const std::vector<GalleryView>& views);

// Depth: near is bright, white is nothing. Fan and polar: colour by the square root of the grey level, for
// faint beds and bright walls. Fan: ahead is up. Polar: nearest range at the top, leftmost beam at the left,
// as in the pictures of other commands.
GalleryPictures MakePictures(const GalleryView& view, double brightest_grey);

// Returns one row per view: depth, fan, polar; on white.
RgbImage Sheet(const std::vector<GalleryPictures>& rows);

}  // namespace sonarcal::report
