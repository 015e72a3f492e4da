// CSV file with column names in its first line and numbers in its cells, accessed by row and name. Cells are
// not quoted. Up to 256 MB, because it is held in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

class CsvTable {
 public:
  // Throws DataError with file and line if there is no line of names, a name occurs twice, or a line has
  // another number of cells.
  explicit CsvTable(const std::filesystem::path& file);
  ~CsvTable() = default;
  // Not copyable, because cells point into the text.
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;

  int rows() const { return static_cast<int>(cells_.size()); }
  bool Has(const std::string& column) const { return columns_.contains(column); }

  // Throw DataError with file, line and column if the column is missing or the cell holds no such number. 3.0
  // is an integer, 3.5 is not.
  double Number(int row, const std::string& column, double lowest, double highest) const;
  std::int64_t Integer(int row, const std::string& column, std::int64_t lowest, std::int64_t highest) const;

 private:
  std::string name_;
  std::string text_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string_view>> cells_;
};

}  // namespace sonarcal::data_io
