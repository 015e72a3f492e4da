// Fits the paper model's parameters to recorded polar images by least squares (Ceres).
//
// The residual of a pixel is the expected image (sim/expected_paper_image.h, the function that also renders)
// minus the recorded one, in units of full scale. Frames are given as echo histograms, so a fit of materials
// casts no ray. Sigmas come from a sandwich covariance over blocks of pixels: neighbouring pixels share
// speckle grain and range errors, and the plain least-squares covariance would be too small.
//
// What the data cannot tell is found and said: a parameter whose material is in no frame, one that makes the
// scaled Jacobian singular, and one whose sigma exceeds a surprising step (parameter_catalog.h) are frozen at
// their initial value, reported as unidentifiable, and the rest is solved again.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/fit_config.h"
#include "calib/fit_report.h"
#include "sim/expected_paper_image.h"

namespace sonarcal {

struct FitFrame {
  int index = 0;  // in the recording
  EchoHistogram echoes;
  std::vector<double> measured;  // range_bins x beams, 0..1 of full scale
  // 1 for the pixels that count; empty: all. For what the scene does not contain.
  std::vector<std::uint8_t> use = {};
};

// Values of an image as a fit wants them. Throws DataError where they are not grey levels.
std::vector<double> MeasuredForFit(const PolarImage& image);

struct FitOptions {
  int max_iterations = 100;          // of each solve
  double function_tolerance = 1e-8;  // relative change of cost that ends a solve
  int starts = 4;                    // curves to start from; the best valley is kept
  int threads = 0;                   // 0 = all cores
  int block_bins = 8;                // pixels of a covariance block; wider than pulse and beam
  int block_beams = 16;
  bool search_level = true;  // look for a starting level and dB range before the first solve
  std::function<void(const std::string&)> progress;  // told what is being done, one line at a time

  // Throws DataError naming field, value and limit.
  void Check() const;
};

struct FitResult {
  ParameterSet parameters;
  FitReport report;
  bool usable = false;  // false: no solution that may be used
};

// All frames share `geometry` and `material_names` (those of the scene). Throws DataError for a configuration
// that names nothing free, or frames that do not fit the geometry.
FitResult FitPaperModel(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
                        const std::vector<std::string>& material_names, const ParameterSet& initial,
                        const FitConfig& config, const FitOptions& options = {});

}  // namespace sonarcal
