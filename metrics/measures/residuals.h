// Where a simulation is wrong: the difference simulated - real of the polar images, by range, by beam, by
// cell of a coarse map, and by whatever classes a caller puts pixels into (incidence angle, material). Sums
// over all frames; no image is kept.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/measures/intensity.h"

namespace sonarcal::metrics {

// Pixels of the whole image, and those of either object region.
struct ResidualSums {
  DifferenceSums whole;
  DifferenceSums union_region;
};

// One line of a table of residuals.
struct ResidualClass {
  std::string name;               // a material's; empty for what is a number
  std::optional<double> from;     // of the class, in the table's unit
  std::optional<double> to = {};  // none with `from`: all beyond
  ResidualSums sums = {};
};

struct ResidualTable {
  std::string by;    // "range", "beam", "incidence", "material"
  std::string unit;  // "m", "degrees"; empty for names
  std::vector<ResidualClass> classes;
};

// Cells of `bins` x `beams` pixels each, those at the far edges smaller.
struct ResidualMap {
  int bins = 1;
  int beams = 1;
  Grid<ResidualSums> cells;
};

class ResidualCollector {
 public:
  // At most this many cells of the map along either side.
  static constexpr int kMapCells = 64;

  // Adds a frame. Frames whose axes differ from the first one's are left out, and counted. Everything
  // range_bins x beam_count; `valid` null: every pixel counts.
  void Add(const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
           const Mask& simulated_object, const Mask* valid = nullptr);

  // Adds a frame to a table of the caller's: `class_of(bin, beam)` is an index into table.classes, or less
  // than 0 for a pixel that belongs to none.
  static void AddTo(ResidualTable& table, const std::function<int(int bin, int beam)>& class_of,
                    const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
                    const Mask& simulated_object, const Mask* valid = nullptr);

  int frames() const { return frames_; }
  int frames_left_out() const { return frames_left_out_; }
  const PolarAxes& axes() const { return axes_; }

  ResidualTable ByRange() const;  // one class a range bin
  ResidualTable ByBeam() const;   // one class a beam, between its edges
  const ResidualMap& map() const { return map_; }

 private:
  PolarAxes axes_;
  int frames_ = 0;
  int frames_left_out_ = 0;
  std::vector<ResidualSums> by_bin_;
  std::vector<ResidualSums> by_beam_;
  ResidualMap map_;
};

// "by,name,from,to,unit,domain,pixels,bias,mean_absolute,rmse", a line a class and domain; RFC 4180.
std::string ResidualsCsv(const std::vector<ResidualTable>& tables);

}  // namespace sonarcal::metrics
