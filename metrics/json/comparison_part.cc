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
#include "data_io/files/hash.h"

namespace sonarcal::metrics {
namespace {

std::string Header() {
  return fmt::format("sonarcal-comparison-part/2 {} {} {}\n", sizeof(ViewMetrics), sizeof(ResidualSums),
                     sizeof(std::size_t));
}

// Writes or reads values one after the other. Visit() below has one order for both. Count() returns the
// number of items of a list, of which each has at least `item_bytes` bytes in the file.
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
  std::size_t Count(std::size_t count, std::size_t /*item_bytes*/) {
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
  std::size_t Count(std::size_t /*unknown*/, std::size_t item_bytes) {
    std::uint64_t count = 0;
    Plain(count);
    Need(count, item_bytes);
    return count;
  }
  void Finish() const {
    if (!bytes_.empty()) throw DataError("{}: has {} bytes after its end", name_, bytes_.size());
  }

 private:
  void Need(std::uint64_t count, std::size_t item_bytes) const {
    if (count > bytes_.size() / item_bytes)
      throw DataError("{}: ends in the middle, expected a whole part of a comparison", name_);
  }

  std::string_view bytes_;
  const std::string& name_;
};

template <typename Archive, typename T>
void List(Archive& archive, std::vector<T>& values) {
  values.resize(archive.Count(values.size(), sizeof(T)));
  archive.Array(values.data(), values.size());
}

template <typename Archive>
void Text(Archive& archive, std::string& text) {
  text.resize(archive.Count(text.size(), 1));
  archive.Array(text.data(), text.size());
}

// Smallest size of a list or a text in the file: that of its count.
constexpr std::size_t kCountBytes = sizeof(std::uint64_t);

template <typename Archive, typename T, typename Each>
void ListOf(Archive& archive, std::vector<T>& values, std::size_t item_bytes, const Each& each) {
  values.resize(archive.Count(values.size(), item_bytes));
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
  ListOf(archive, frame.notes, kCountBytes, [&](std::string& note) { Text(archive, note); });
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
  ListOf(archive, table.classes, sizeof(ResidualSums), [&](ResidualClass& of) {
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
        const std::size_t cols = archive.Count(map.cells.cols(), sizeof(ResidualSums));
        const std::size_t rows = archive.Count(map.cells.rows(), std::max(cols, 1UL) * sizeof(ResidualSums));
        Grid<ResidualSums> cells(static_cast<int>(rows), static_cast<int>(cols));
        std::ranges::copy(map.cells.values(), cells.values().begin());
        archive.Array(cells.values().data(), cells.size());
        map.cells = std::move(cells);
      });
}

template <typename Archive>
void Visit(Archive& archive, ComparisonPart& part) {
  Text(archive, part.compared);
  Text(archive, part.simulated);
  ListOf(archive, part.frames, sizeof(ViewMetrics), [&](FrameMetrics& frame) { Visit(archive, frame); });
  Visit(archive, part.levels.polar);
  Visit(archive, part.levels.fan);
  Visit(archive, part.residuals);
  ListOf(archive, part.residuals_by_scene, kCountBytes, [&](ResidualTable& table) { Visit(archive, table); });
  ListOf(archive, part.notes, kCountBytes, [&](std::string& note) { Text(archive, note); });
}

void AddTables(const std::vector<ResidualTable>& from, std::vector<ResidualTable>& to) {
  if (to.empty()) {
    to = from;
    return;
  }
  const auto check_sizes = [](const auto& a, const auto& b) {
    if (a.size() == b.size()) return;
    throw DataError("parts have {} and {} classes of residuals, expected as many", a.size(), b.size());
  };
  check_sizes(from, to);
  for (std::size_t i = 0; i < from.size(); ++i) {
    check_sizes(from[i].classes, to[i].classes);
    for (std::size_t k = 0; k < from[i].classes.size(); ++k) to[i].classes[k].sums += from[i].classes[k].sums;
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
  return Header() + data_io::Sha256(writer.bytes_) + writer.bytes_;
}

ComparisonPart ParseComparisonPart(std::string_view bytes, const std::string& name) {
  const std::string header = Header();
  if (!bytes.starts_with(header)) {
    throw DataError("{}: is no part of a comparison by this version of the program, expected '{}'", name,
                    header.substr(0, header.size() - 1));
  }
  constexpr std::size_t kHashDigits = 64;
  const std::string_view hash = bytes.substr(header.size(), kHashDigits);
  bytes.remove_prefix(header.size() + hash.size());
  if (hash != data_io::Sha256(bytes)) {
    throw DataError("{}: is damaged: its bytes do not have the hash that it states, expected a whole part",
                    name);
  }
  Reader reader(bytes, name);
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
