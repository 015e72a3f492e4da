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

#include <string>
#include <vector>

#include "calib/fit_config.h"
#include "calib/fit_options.h"
#include "calib/fit_report.h"
#include "calib/frame_model.h"
#include "calib/paper_frame_model.h"

namespace sonarcal {

// Values of an image as a fit wants them. Throws DataError where they are not grey levels.
std::vector<double> MeasuredForFit(const PolarImage& image);

// What a fit of any model found.
struct ModelFit {
  ParameterValues values;
  FitReport report;
  bool usable = false;  // false: no solution that may be used
};

// Throws DataError for a configuration that names nothing free.
ModelFit Fit(const FrameModel& model, const ParameterValues& initial, const FitConfig& config,
             const FitOptions& options = {});

struct FitResult {
  ParameterSet parameters;
  FitReport report;
  bool usable = false;  // false: no solution that may be used
};

// What a fit of the paper model frees by default. The gauge: source level and db_min stay, so that the level
// is carried by the materials.
std::vector<std::string> PaperFreeByDefault();

// All frames share `geometry` and `material_names` (those of the scene). Throws DataError for a configuration
// that names nothing free, or frames that do not fit the geometry.
FitResult FitPaperModel(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
                        const std::vector<std::string>& material_names, const ParameterSet& initial,
                        const FitConfig& config, const FitOptions& options = {});

}  // namespace sonarcal
