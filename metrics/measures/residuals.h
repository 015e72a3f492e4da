// Residuals of a simulation: the difference simulated - real of the polar images by range, by beam, by cell
// of a coarse map, and by classes that a caller assigns to pixels (incidence angle, material). Sums over all
// frames; no image is kept.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "metrics/measures/intensity.h"

namespace sonarcal::metrics {

// Sums over the whole image, and over the union of both object regions.
struct ResidualSums {
  DifferenceSums whole;
  DifferenceSums union_region;

  ResidualSums& operator+=(const ResidualSums& other) {
    whole += other.whole;
    union_region += other.union_region;
    return *this;
  }
};

// One row of a table of residuals.
struct ResidualClass {
  std::string name;               // name of a material; empty for a numeric class
  std::optional<double> from;     // limits of the class, in the table's unit
  std::optional<double> to = {};  // none while `from` is set: no upper limit
  ResidualSums sums = {};
};

struct ResidualTable {
  std::string by;    // "range", "beam", "incidence", "material"
  std::string unit;  // "m", "degrees"; empty for names
  std::vector<ResidualClass> classes;
};

// Cells of `bins` x `beams` pixels each; those at the far edges are smaller.
struct ResidualMap {
  int bins = 1;
  int beams = 1;
  Grid<ResidualSums> cells;
};

class ResidualCollector {
 public:
  // Max number of cells of the map along each side.
  static constexpr int kMapCells = 64;

  // Adds a frame. Omits and counts frames whose axes differ from the first one's. All arrays are range_bins x
  // beam_count; `valid` null: every pixel is valid.
  void Add(const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
           const Mask& simulated_object, const Mask* valid = nullptr);

  // Adds what another collector has of other frames. Omits and counts them if its axes differ.
  ResidualCollector& operator+=(const ResidualCollector& other);

  // Passes all members to `visit`, for a file of them.
  template <typename Visitor>
  static void VisitMembers(ResidualCollector& self, const Visitor& visit) {
    visit(self.axes_, self.frames_, self.frames_left_out_, self.by_bin_, self.by_beam_, self.map_);
  }

  // Adds a frame to a table of the caller. `class_of(bin, beam)` is an index into table.classes, or negative
  // for a pixel without a class.
  static void AddTo(ResidualTable& table, const std::function<int(int bin, int beam)>& class_of,
                    const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
                    const Mask& simulated_object, const Mask* valid = nullptr);

  int frames() const { return frames_; }
  int frames_left_out() const { return frames_left_out_; }
  const PolarAxes& axes() const { return axes_; }

  ResidualTable ByRange() const;  // one class per range bin
  ResidualTable ByBeam() const;   // one class per beam, between its edges
  const ResidualMap& map() const { return map_; }

 private:
  PolarAxes axes_;
  int frames_ = 0;
  int frames_left_out_ = 0;
  std::vector<ResidualSums> by_bin_;
  std::vector<ResidualSums> by_beam_;
  ResidualMap map_;
};

// CSV (RFC 4180) with the header "by,name,from,to,unit,domain,pixels,bias,mean_absolute,rmse", one line per
// class and domain.
std::string ResidualsCsv(const std::vector<ResidualTable>& tables);

}  // namespace sonarcal::metrics
