#include "data_io/files/csv_table.h"

#include <cmath>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kMaxBytes = 256 << 20;

std::vector<std::string_view> Split(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = line.find(',');
    cells.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file)
    : name_(file.string()), text_(ReadFileBytes(file, kMaxBytes)) {
  std::string_view rest = text_;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = rest.find('\n');
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::vector<std::string_view> cells = Split(line);
    if (number == 1) {
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!columns_.emplace(cells[i], i).second)
          throw DataError("{}:1: two columns are named '{}'", name_, Printable(cells[i]));
      }
      continue;
    }
    if (cells.size() != columns_.size()) {
      throw DataError("{}:{}: {} cells, expected {} as the first line names", name_, number, cells.size(),
                      columns_.size());
    }
    cells_.push_back(std::move(cells));
  }
  if (columns_.empty()) throw DataError("{}: empty, expected a line that names the columns", name_);
}

double CsvTable::Number(int row, const std::string& column, double lowest, double highest) const {
  const auto index = columns_.find(column);
  if (index == columns_.end()) throw DataError("{}:1: no column '{}', expected one", name_, column);
  const std::string_view cell = cells_.at(row)[index->second];
  double value = 0.0;
  // Negated so that NaN is rejected too.
  if (!ParseNumber(cell, value) || !(value >= lowest && value <= highest)) {
    throw DataError("{}:{}: {} is '{}', expected a number within {:g}..{:g}", name_, row + 2, column,
                    Printable(cell), lowest, highest);
  }
  return value;
}

std::int64_t CsvTable::Integer(int row, const std::string& column, std::int64_t lowest,
                               std::int64_t highest) const {
  const double value = Number(row, column, static_cast<double>(lowest), static_cast<double>(highest));
  if (value != std::floor(value))
    throw DataError("{}:{}: {} is {}, expected a whole number", name_, row + 2, column, value);
  return static_cast<std::int64_t>(value);
}

}  // namespace sonarcal::data_io
