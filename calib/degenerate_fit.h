// Whether a fit of the paper's model is degenerate: whether its values are those of a model that does not
// describe the recording, pushed to an extreme where it looks least wrong.
#pragma once

#include <string>
#include <vector>

#include "calib/fit_report.h"
#include "calib/models/paper_frame_model.h"

namespace sonarcal::calib {

// Another place where the search ended, from another start.
struct OtherOptimum {
  double cost = 0.0;
  double difference = 0.0;  // RMS difference of the two expected images, of full scale
};

// The signs of a degenerate fit that are found, one full sentence each without a full stop; none where the
// fit is sound. `clipping` and `others` belong to the fitted values.
std::vector<std::string> DegenerateFitWarnings(const FitReport& report, const PaperClipping& clipping,
                                               const std::vector<OtherOptimum>& others);

}  // namespace sonarcal::calib
