// Options of the solver of a fit. What a fit may change is in fit_config.h.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace sonarcal::calib {

// Thrown when the caller cancels a fit. No result is available.
class FitStopped : public std::runtime_error {
 public:
  FitStopped() : std::runtime_error("the fit was stopped") {}
};

struct FitOptions {
  int max_iterations = 100;          // per solve
  double function_tolerance = 1e-8;  // relative change of cost that ends a solve
  int starts = 4;                    // curves to start from; keeps the best valley
  int threads = 0;                   // 0 = all cores
  int block_bins = 8;                // min size of a covariance block in pixels; if pulse or beam are wide,
  int block_beams = 16;              // eight of their widths
  bool search_level = true;          // searches a start level and dB range before the first solve
  bool test_others = true;  // tests if other curves (calib/curve_alternatives.h) or poses fit equally well
  int joint_steps = 20;     // max number of steps of placements and curves together, each traced
  bool near_start = false;  // placements start near their best values: leaves out searches
  bool rough = false;       // ends after the starts, with values but no sigmas, for a fit in rounds
  bool standard_errors = true;  // false: a likelihood's fit gives values without standard errors
  // Weights of frames of one pose, per frame and pixel, from an earlier fit to the same pixels. Costs of two
  // fits are comparable only with equal weights. Empty: the fit computes its own weights.
  std::vector<std::vector<float>> repeat_shares = {};
  bool down_weight = false;  // reduces the weight of pixels that do not match the scene (acoustic model)
  std::function<void(const std::string&)> progress;  // receives messages, one line each
  // Called after each step of a solver. If it returns true, the fit throws FitStopped.
  std::function<bool()> stop = {};

  // Throws DataError with field, value and limit.
  void Check() const;
};

}  // namespace sonarcal::calib
