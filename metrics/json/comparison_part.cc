#include "metrics/json/comparison_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

constexpr std::uint64_t kMaxCount = 1UL << 32U;

std::string Header() {
  return fmt::format("sonarcal-comparison-part/1 {} {} {}\n", sizeof(ViewMetrics), sizeof(ResidualSums),
                     sizeof(std::size_t));
}

// Writes or reads values one after the other. Visit() below has one order for both.
class Writer {
 public:
  template <typename T>
  void Plain(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <typename T>
  void Array(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
  }
  // Returns the number of items of a list.
  std::size_t Count(std::size_t count) {
    Plain(std::uint64_t{count});
    return count;
  }
  std::string bytes_;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  template <typename T>
  void Plain(T& value) {
    Array(&value, 1);
  }
  template <typename T>
  void Array(T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    Need(count, sizeof(T));
    if (count > 0) std::memcpy(values, bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
  }
  std::size_t Count(std::size_t /*unknown*/) {
    std::uint64_t count = 0;
    Plain(count);
    Need(count, 1);
    return count;
  }
  void Finish() const {
    if (!bytes_.empty()) throw DataError("{}: has {} bytes after its end", name_, bytes_.size());
  }

 private:
  void Need(std::uint64_t count, std::size_t size) const {
    if (count > kMaxCount || count * size > bytes_.size())
      throw DataError("{}: ends in the middle, expected a whole part of a comparison", name_);
  }

  std::string_view bytes_;
  const std::string& name_;
};

template <typename Archive, typename T>
void List(Archive& archive, std::vector<T>& values) {
  values.resize(archive.Count(values.size()));
  archive.Array(values.data(), values.size());
}

template <typename Archive>
void Text(Archive& archive, std::string& text) {
  text.resize(archive.Count(text.size()));
  archive.Array(text.data(), text.size());
}

template <typename Archive, typename T, typename Each>
void ListOf(Archive& archive, std::vector<T>& values, const Each& each) {
  values.resize(archive.Count(values.size()));
  for (T& value : values) each(value);
}

template <typename Archive>
void Visit(Archive& archive, FrameMetrics& frame) {
  archive.Plain(frame.index);
  Text(archive, frame.name);
  archive.Plain(frame.time_s);
  archive.Plain(frame.polar);
  archive.Plain(frame.fan);
  archive.Plain(frame.threshold_real);
  archive.Plain(frame.threshold_simulated);
  ListOf(archive, frame.notes, [&](std::string& note) { Text(archive, note); });
  archive.Plain(frame.object_box);
  List(archive, frame.sweep);
}

template <typename Archive>
void Visit(Archive& archive, LevelHistograms& levels) {
  for (LevelCounts& counts : levels.over) {
    List(archive, counts.real);
    List(archive, counts.simulated);
  }
  archive.Plain(levels.span_db);
}

template <typename Archive>
void Visit(Archive& archive, ResidualTable& table) {
  Text(archive, table.by);
  Text(archive, table.unit);
  ListOf(archive, table.classes, [&](ResidualClass& of) {
    Text(archive, of.name);
    archive.Plain(of.from);
    archive.Plain(of.to);
    archive.Plain(of.sums);
  });
}

template <typename Archive>
void Visit(Archive& archive, ResidualCollector& residuals) {
  ResidualCollector::VisitMembers(
      residuals, [&](PolarAxes& axes, int& frames, int& left_out, std::vector<ResidualSums>& by_bin,
                     std::vector<ResidualSums>& by_beam, ResidualMap& map) {
        archive.Plain(axes.range_min_m);
        archive.Plain(axes.range_max_m);
        archive.Plain(axes.range_bins);
        List(archive, axes.beam_azimuth_rad);
        archive.Plain(frames);
        archive.Plain(left_out);
        List(archive, by_bin);
        List(archive, by_beam);
        archive.Plain(map.bins);
        archive.Plain(map.beams);
        const auto rows = static_cast<int>(archive.Count(map.cells.rows()));
        const auto cols = static_cast<int>(archive.Count(map.cells.cols()));
        if (map.cells.rows() != rows || map.cells.cols() != cols) map.cells = Grid<ResidualSums>(rows, cols);
        archive.Array(map.cells.values().data(), map.cells.size());
      });
}

template <typename Archive>
void Visit(Archive& archive, ComparisonPart& part) {
  Text(archive, part.compared);
  Text(archive, part.simulated);
  ListOf(archive, part.frames, [&](FrameMetrics& frame) { Visit(archive, frame); });
  Visit(archive, part.levels.polar);
  Visit(archive, part.levels.fan);
  Visit(archive, part.residuals);
  ListOf(archive, part.residuals_by_scene, [&](ResidualTable& table) { Visit(archive, table); });
  ListOf(archive, part.notes, [&](std::string& note) { Text(archive, note); });
}

void AddTables(const std::vector<ResidualTable>& from, std::vector<ResidualTable>& to) {
  if (to.empty()) {
    to = from;
    return;
  }
  for (std::size_t i = 0; i < std::min(from.size(), to.size()); ++i) {
    for (std::size_t k = 0; k < std::min(from[i].classes.size(), to[i].classes.size()); ++k)
      to[i].classes[k].sums += from[i].classes[k].sums;
  }
}

}  // namespace

void ComparisonPart::Add(const FrameMetrics& frame) {
  levels += frame.levels.value();
  frames.push_back(frame);
  frames.back().levels.reset();
  frames.back().masks.reset();
}

std::string ComparisonPartBytes(const ComparisonPart& part) {
  Writer writer;
  ComparisonPart copy = part;  // one order of members for both directions
  Visit(writer, copy);
  return Header() + writer.bytes_;
}

ComparisonPart ParseComparisonPart(std::string_view bytes, const std::string& name) {
  const std::string header = Header();
  if (!bytes.starts_with(header)) {
    throw DataError("{}: is no part of a comparison by this version of the program, expected '{}'", name,
                    header.substr(0, header.size() - 1));
  }
  Reader reader(bytes.substr(header.size()), name);
  ComparisonPart part;
  Visit(reader, part);
  reader.Finish();
  return part;
}

ComparisonPart MergedParts(std::vector<ComparisonPart> parts) {
  std::erase_if(parts, [](const ComparisonPart& part) { return part.frames.empty(); });
  if (parts.empty()) throw DataError("no part of a comparison has a frame, expected at least one");
  std::ranges::stable_sort(parts, {}, [](const ComparisonPart& part) { return part.frames.front().index; });
  ComparisonPart merged;
  merged.compared = parts.front().compared;
  merged.simulated = parts.front().simulated;
  std::set<std::string> notes;
  for (ComparisonPart& part : parts) {
    if (part.compared != merged.compared) {
      throw DataError("parts of different comparisons: {} and {}, expected the same options", merged.compared,
                      part.compared);
    }
    std::ranges::move(part.frames, std::back_inserter(merged.frames));
    merged.levels += part.levels;
    merged.residuals += part.residuals;
    AddTables(part.residuals_by_scene, merged.residuals_by_scene);
    notes.insert(part.notes.begin(), part.notes.end());
  }
  std::ranges::stable_sort(merged.frames, {}, &FrameMetrics::index);
  const auto twice = std::ranges::adjacent_find(merged.frames, {}, &FrameMetrics::index);
  if (twice != merged.frames.end()) throw DataError("frame {} is in two parts, expected one", twice->index);
  merged.notes.assign(notes.begin(), notes.end());
  return merged;
}

}  // namespace sonarcal::metrics
