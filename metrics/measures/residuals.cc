#include "metrics/measures/residuals.h"

#include "core/types/csv_text.h"
#include "core/types/units.h"

namespace sonarcal::metrics {
namespace {

int CellSize(int pixels) {
  return (pixels + ResidualCollector::kMapCells - 1) / ResidualCollector::kMapCells;
}

// Calls take(bin, beam, r, s, in_union) for every valid pixel.
template <typename Take>
void ForEachPixel(const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
                  const Mask& simulated_object, const Mask* valid, Take&& take) {
  const double full_scale = real.scale.full_scale;
  for (int bin = 0; bin < real.value.rows(); ++bin) {
    for (int beam = 0; beam < real.value.cols(); ++beam) {
      if (valid != nullptr && (*valid)(bin, beam) == 0) continue;
      take(bin, beam, static_cast<double>(real.value(bin, beam)) / full_scale,
           static_cast<double>(simulated.value(bin, beam)) / full_scale,
           real_object(bin, beam) != 0 || simulated_object(bin, beam) != 0);
    }
  }
}

void AddPixel(ResidualSums& sums, double r, double s, bool in_union) {
  sums.whole.Add(r, s);
  if (in_union) sums.union_region.Add(r, s);
}

}  // namespace

void ResidualCollector::Add(const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
                            const Mask& simulated_object, const Mask* valid) {
  if (frames_ == 0) {
    axes_ = real.axes;
    by_bin_.resize(axes_.range_bins);
    by_beam_.resize(axes_.beam_count());
    map_.bins = CellSize(axes_.range_bins);
    map_.beams = CellSize(axes_.beam_count());
    map_.cells = Grid<ResidualSums>((axes_.range_bins + map_.bins - 1) / map_.bins,
                                    (axes_.beam_count() + map_.beams - 1) / map_.beams);
  } else if (!axes_.Matches(real.axes)) {
    ++frames_left_out_;
    return;
  }
  ++frames_;
  ForEachPixel(real, simulated, real_object, simulated_object, valid,
               [&](int bin, int beam, double r, double s, bool in_union) {
                 AddPixel(by_bin_[bin], r, s, in_union);
                 AddPixel(by_beam_[beam], r, s, in_union);
                 AddPixel(map_.cells(bin / map_.bins, beam / map_.beams), r, s, in_union);
               });
}

ResidualCollector& ResidualCollector::operator+=(const ResidualCollector& other) {
  // A collector that has no frame has left out none: its first frame sets the axes.
  if (other.frames_ == 0) return *this;
  if (frames_ == 0) return *this = other;
  frames_left_out_ += other.frames_left_out_;
  if (!axes_.Matches(other.axes_)) {
    frames_left_out_ += other.frames_;
    return *this;
  }
  frames_ += other.frames_;
  for (std::size_t i = 0; i < by_bin_.size(); ++i) by_bin_[i] += other.by_bin_[i];
  for (std::size_t i = 0; i < by_beam_.size(); ++i) by_beam_[i] += other.by_beam_[i];
  for (std::size_t i = 0; i < map_.cells.size(); ++i) map_.cells.values()[i] += other.map_.cells.values()[i];
  return *this;
}

void ResidualCollector::AddTo(ResidualTable& table, const std::function<int(int bin, int beam)>& class_of,
                              const PolarImage& real, const PolarImage& simulated, const Mask& real_object,
                              const Mask& simulated_object, const Mask* valid) {
  ForEachPixel(real, simulated, real_object, simulated_object, valid,
               [&](int bin, int beam, double r, double s, bool in_union) {
                 const int index = class_of(bin, beam);
                 if (index >= 0) AddPixel(table.classes.at(index).sums, r, s, in_union);
               });
}

ResidualTable ResidualCollector::ByRange() const {
  ResidualTable table{.by = "range", .unit = "m", .classes = {}};
  for (std::size_t bin = 0; bin < by_bin_.size(); ++bin) {
    const double from = axes_.range_edge_m(static_cast<int>(bin));
    table.classes.push_back(
        {.name = {}, .from = from, .to = from + axes_.range_bin_m(), .sums = by_bin_[bin]});
  }
  return table;
}

ResidualTable ResidualCollector::ByBeam() const {
  ResidualTable table{.by = "beam", .unit = "degrees", .classes = {}};
  if (by_beam_.empty()) return table;
  const std::vector<double> edges_rad = axes_.BeamEdgesRad();
  for (std::size_t beam = 0; beam < by_beam_.size(); ++beam) {
    table.classes.push_back({.name = {},
                             .from = DegFromRad(edges_rad[beam]),
                             .to = DegFromRad(edges_rad[beam + 1]),
                             .sums = by_beam_[beam]});
  }
  return table;
}

std::string ResidualsCsv(const std::vector<ResidualTable>& tables) {
  std::string csv = "by,name,from,to,unit,domain,pixels,bias,mean_absolute,rmse\n";
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
  };
  for (const ResidualTable& table : tables) {
    for (const ResidualClass& line : table.classes) {
      const auto add = [&](const char* domain, const DifferenceSums& sums) {
        csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", table.by, CsvText(line.name), number(line.from),
                           number(line.to), table.unit, domain, sums.pixels, number(sums.bias()),
                           number(sums.mean_absolute()), number(sums.rmse()));
      };
      add("whole", line.sums.whole);
      add("union", line.sums.union_region);
    }
  }
  return csv;
}

}  // namespace sonarcal::metrics
