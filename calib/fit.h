// Fits the parameters of an image model to recorded polar images by least squares (Ceres).
//
// The model is a FrameModel (calib/models/frame_model.h): the paper's or the acoustic one. FitPaperModel fits
// the paper's model. Its residual is the expected recorded value minus the recorded one
// (calib/paper/paper_likelihood.h), in units of the noise that the frames show. Its frames are echo
// histograms, so a fit of materials casts no ray. calib/acoustic_fit.h fits the acoustic model.
//
// Standard errors come from a sandwich covariance over blocks of pixels. The plain least-squares covariance
// would be too small, because neighbouring pixels share speckle cells and range errors.
// If the model is given with other rays too, the difference that rays make is part of them.
//
// Parameters that the data do not determine are reported:
//
// - One whose material is in no frame keeps its value.
// - The others have priors. One that keeps most of its prior's variance is reported as unidentifiable.
//   Without noise there are no priors; such parameters are then fixed at their initial value, and the rest is
//   solved again.
// - In a fit by likelihood, parameters of curves that other curves fit as well (calib/curve_alternatives.h)
//   are reported as unidentifiable, without sigma.
#pragma once

#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/models/frame_model.h"
#include "calib/paper/paper_frame_model.h"
#include "calib/parameters/fit_config.h"
#include "calib/parameters/fit_options.h"

namespace sonarcal::calib {

// Returns the values of an image, as a fraction of full scale. Throws DataError if they are not grey levels.
std::vector<double> MeasuredForFit(const PolarImage& image);

// Returns one grey level as a fraction of full scale if all values are whole numbers; 0 if they are not
// rounded.
double GreyLevel(const PolarImage& image);

// Result of a fit of any model.
struct ModelFit {
  ParameterValues values;
  FitReport report;
  bool usable = false;  // false: no usable solution
};

// `by_other_rays`, if given, is the model of the same frames about the same point with other rays. What both
// differ by adds to the standard errors. Throws DataError if the configuration frees nothing.
ModelFit Fit(const FrameModel& model, const ParameterValues& initial, const FitConfig& config,
             const FitOptions& options = {}, const FrameModel* by_other_rays = nullptr);

struct FitResult {
  ParameterSet parameters;
  FitReport report;
  bool usable = false;  // false: no usable solution
};

// Returns the parameters that a fit of the paper's model frees by default. Gauge: source level and db_min are
// fixed, so that the materials carry the level.
std::vector<std::string> PaperFreeByDefault();

// All frames share `geometry` and `material_names` (those of the scene). Throws DataError if the
// configuration frees nothing or if frames do not fit the geometry.
FitResult FitPaperModel(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                        const std::vector<std::string>& material_names, const ParameterSet& initial,
                        const FitConfig& config, const FitOptions& options = {});

}  // namespace sonarcal::calib
