// Signs of a degenerate fit of the paper's model: the model does not describe the recording, and its values
// went to an extreme where it looks least wrong.
#pragma once

#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/paper/paper_frame_model.h"

namespace sonarcal::calib {

// Two optima are different if the RMS difference of their images exceeds this fraction of full scale.
inline constexpr double kOtherImage = 0.01;

// Another optimum, found from another start.
struct OtherOptimum {
  double cost = 0.0;
  double difference = 0.0;  // RMS difference of the two expected images, as a fraction of full scale
};

// Returns one sentence per sign of a degenerate fit, without a full stop; none for a sound fit. `clipping`
// and `others` belong to the fitted values.
std::vector<std::string> DegenerateFitWarnings(const FitReport& report, const PaperClipping& clipping,
                                               const std::vector<OtherOptimum>& others);

}  // namespace sonarcal::calib
