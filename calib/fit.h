// Fits a model's parameters to recorded polar images by least squares (Ceres).
//
// The residual of a pixel of the paper's model is the expected recorded value minus the recorded one
// (calib/models/paper_likelihood.h), in units of the noise that the frames show. Frames are given as echo
// histograms, so a fit of materials casts no ray. Sigmas come from a sandwich covariance over blocks of
// pixels: neighbouring pixels share speckle grain and range errors, and the plain least-squares covariance
// would be too small.
//
// Parameters that the data do not determine are reported: one whose material is in no frame keeps its value;
// others have priors, and where the data leave most of a prior's variance, a parameter is reported as
// unidentifiable. (Without noise there are no priors: then parameters that the data leave open are held at
// their initial value, and the rest is solved again.)
// In a fit by likelihood, what other curves fit as well (calib/curve_alternatives.h) is reported alike,
// without sigma.
#pragma once

#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/models/frame_model.h"
#include "calib/models/paper_frame_model.h"
#include "calib/parameters/fit_config.h"
#include "calib/parameters/fit_options.h"

namespace sonarcal::calib {

// Values of an image as a fit wants them. Throws DataError where they are not grey levels.
std::vector<double> MeasuredForFit(const PolarImage& image);

// One grey level, of full scale, where all values are whole; 0 where they are not rounded.
double GreyLevel(const PolarImage& image);

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
FitResult FitPaperModel(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                        const std::vector<std::string>& material_names, const ParameterSet& initial,
                        const FitConfig& config, const FitOptions& options = {});

}  // namespace sonarcal::calib
