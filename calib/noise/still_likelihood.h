// Likelihood of the grey levels of static frames by the noise level, for unknown echoes. Used by
// calib/noise/still_frames.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types/parameters.h"

namespace sonarcal::calib {

// Classes of grey levels: one per level up to 512 levels, wider ones beyond.
class GreyClasses {
 public:
  GreyClasses(const DisplayParameters<double>& display, double full_scale);

  int count() const { return static_cast<int>(edges_.size()) + 1; }
  int Of(double grey) const;
  bool IsTop(int of_class) const { return of_class == count() - 1; }
  // Powers between the classes, ascending: class c lies between edge c - 1 and edge c.
  const std::vector<double>& edges() const { return edges_; }
  // power at its middle; for the first and last class, at its edge
  double Power(int of_class) const { return power_[of_class]; }

 private:
  int levels_in_class_ = 1;
  std::vector<double> edges_;
  std::vector<double> power_;
};

// Least limit for the level of pixels above the noise. With thousands of frames or looks, the amplitude nodes
// are farther apart to reach it.
inline constexpr double kMinBrightestDb = 10.0;

// Returns how far above the noise pixels may lie: `asked_db`, limited by the max number of nodes for this
// number of frames, but at least kMinBrightestDb.
double BrightestUsedDb(double looks, int frames, double asked_db);

class StillLikelihood {
 public:
  // `classes_of`: classes of all frames, pixel by pixel. Noise shapes (still_frames.h) are rounded to 0.5 dB.
  // No pixel may exceed the noise by more than `brightest_db`.
  StillLikelihood(const GreyClasses& classes, double looks, int frames, std::vector<std::uint16_t> classes_of,
                  const std::vector<float>& noise_shape_db, double brightest_db);

  // Returns the log-likelihood per pixel at a noise level, with the best weights of the echo amplitudes.
  // Starts from `weights` (empty: uniform over the complex plane) and returns the best ones there.
  std::vector<double> Profile(double noise_db, std::vector<double>& weights) const;

  // Expectation of each pixel's echo power given its levels, at this noise level and these weights.
  std::vector<double> EchoPower(double noise_db, const std::vector<double>& weights) const;

 private:
  // Likelihood of a pixel at the amplitudes where it is not negligible, scaled to a max of 1.
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
  std::vector<double> amplitude_;  // of the nodes, in units of the noise amplitude
};

}  // namespace sonarcal::calib
