// Likelihood of the grey levels of still frames by the noise level, whatever the echoes are: the machinery of
// calib/noise/still_frames.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/parameters.h"

namespace sonarcal::calib {

// Grey levels in classes: level by level up to 512 of them, wider ones beyond.
class GreyClasses {
 public:
  GreyClasses(const DisplayParameters<double>& display, double full_scale);

  int count() const { return static_cast<int>(edges_.size()) + 1; }
  int Of(double grey) const;
  bool IsTop(int of_class) const { return of_class == count() - 1; }
  // Powers between the classes, rising: class c lies between edge c - 1 and edge c.
  const std::vector<double>& edges() const { return edges_; }
  double Power(int of_class) const { return power_[of_class]; }  // of its middle; of an end, its edge

 private:
  int levels_in_class_ = 1;
  std::vector<double> edges_;
  std::vector<double> power_;
};

// How far above the noise pixels may lie: no further than asked for, and than the nodes reach that many
// frames can pay for.
double BrightestTellingDb(double looks, int frames, double asked_db);

class StillLikelihood {
 public:
  // `classes_of`: pixel by pixel, the classes of all frames. Noise shapes (still_frames.h) are rounded to
  // half a dB. No pixel lies further above the noise than `brightest_db`.
  StillLikelihood(const GreyClasses& classes, double looks, int frames, std::vector<std::uint16_t> classes_of,
                  const std::vector<float>& noise_shape_db, double brightest_db);

  // Of the noise level, the best weights of echo amplitudes given: log-likelihood by pixel. Starts from
  // `weights` (empty: evenly over the complex plane) and leaves what it found there.
  std::vector<double> Profile(double noise_db, std::vector<double>& weights) const;

  // Expectation of each pixel's echo power given its levels, at the noise level and weights.
  std::vector<double> EchoPower(double noise_db, const std::vector<double>& weights) const;

 private:
  // A pixel's likelihood at the amplitudes where it is not negligible, of largest value 1.
  struct Window {
    std::uint32_t first_node = 0;
    std::uint32_t count = 0;
    std::size_t start = 0;
    double log_scale = 0.0;
  };
  struct Chunk {
    std::vector<Window> windows;
    std::vector<float> values;
  };

  std::size_t size() const { return shape_index_.size(); }
  std::vector<std::vector<float>> LogTables(double noise_db) const;
  std::vector<Chunk> Chunks(double noise_db) const;

  const GreyClasses& classes_;
  double looks_;
  int frames_;
  std::vector<std::uint16_t> classes_of_;
  std::vector<double> shapes_db_;
  std::vector<std::uint16_t> shape_index_;
  std::vector<double> amplitude_;  // of the nodes, in those of the noise
};

}  // namespace sonarcal::calib
