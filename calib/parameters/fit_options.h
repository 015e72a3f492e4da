// How a fit is solved; what it may change is in fit_config.h.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace sonarcal::calib {

// A fit that was stopped by who asked for it. There is nothing to be had of it.
class FitStopped : public std::runtime_error {
 public:
  FitStopped() : std::runtime_error("the fit was stopped") {}
};

struct FitOptions {
  int max_iterations = 100;          // of each solve
  double function_tolerance = 1e-8;  // relative change of cost that ends a solve
  int starts = 4;                    // curves to start from; the best valley is kept
  int threads = 0;                   // 0 = all cores
  int block_bins = 8;                // pixels of a covariance block, at least: where pulse or beam are wide,
  int block_beams = 16;              // eight of their widths
  bool search_level = true;          // look for a starting level and dB range before the first solve
  bool test_curves = true;   // ask whether other values of a curve fit as well (calib/curve_alternatives.h)
  bool rough = false;        // end after the starts, with values but no sigmas: for a round among others
  bool down_weight = false;  // let pixels that the scene does not explain count less (acoustic model)
  std::function<void(const std::string&)> progress;  // told what is being done, one line at a time
  // Asked after each step of a solver; once it says so, the fit ends by throwing FitStopped.
  std::function<bool()> stop = {};

  // Throws DataError naming field, value and limit.
  void Check() const;
};

}  // namespace sonarcal::calib
