#include "data_io/recordings/npz_writer.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_writer.h"
#include "data_io/recordings/frame_storage.h"
#include "data_io/recordings/recording_json.h"

namespace sonarcal::data_io {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// Header of a .npy file, version 1.0: magic, length, and a Python dictionary padded to 64 bytes.
// numpy.org/doc/stable/reference/generated/numpy.lib.format.html
std::string NpyHead(const std::string& type, const std::vector<std::size_t>& shape) {
  std::string tuple;
  for (const std::size_t extent : shape) tuple += fmt::format("{},", extent);
  std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, tuple);
  constexpr std::size_t kBefore = 10;
  while ((kBefore + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
  dictionary += '\n';
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(dictionary.size() & 0xFF);
  head += static_cast<char>(dictionary.size() >> 8);
  return head + dictionary;
}

// Zip archive that is written array by array.
class Zip {
 public:
  explicit Zip(const std::filesystem::path& file)
      : file_(file), archive_(archive_write_new(), archive_write_free) {
    Check(archive_write_set_format_zip(archive_.get()));
    Check(archive_write_zip_set_compression_deflate(archive_.get()));
    Check(archive_write_open_filename(archive_.get(), file.c_str()));
  }

  // Starts an array. The caller must then write as many bytes as its shape requires.
  void Begin(const std::string& name, const std::string& type, const std::vector<std::size_t>& shape,
             std::size_t bytes_an_element) {
    const std::string head = NpyHead(type, shape);
    std::size_t bytes = bytes_an_element;
    for (const std::size_t extent : shape) bytes *= extent;
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(),
                                                                              archive_entry_free);
    archive_entry_set_pathname(entry.get(), fmt::format("{}.npy", name).c_str());
    archive_entry_set_filetype(entry.get(), AE_IFREG);
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_size(entry.get(), static_cast<la_int64_t>(head.size() + bytes));
    Check(archive_write_header(archive_.get(), entry.get()));
    Write(head.data(), head.size());
  }

  void Write(const void* data, std::size_t bytes) {
    if (archive_write_data(archive_.get(), data, bytes) != static_cast<la_ssize_t>(bytes)) Fail();
  }

  void Add(const std::string& name, const std::vector<double>& values,
           const std::vector<std::size_t>& shape) {
    Begin(name, "<f8", shape, sizeof(double));
    Write(values.data(), values.size() * sizeof(double));
  }

  void Close() { Check(archive_write_close(archive_.get())); }

 private:
  void Check(int status) {
    if (status != ARCHIVE_OK) Fail();
  }
  [[noreturn]] void Fail() {
    const int number = archive_errno(archive_.get());
    FailToWrite(file_, {number > 0 ? number : EIO, std::generic_category()});
  }

  std::filesystem::path file_;
  std::unique_ptr<archive, decltype(&archive_write_free)> archive_;
};

template <typename T>
void WriteRounded(Zip& zip, const Grid<float>& values) {
  std::vector<T> rounded;
  rounded.reserve(values.size());
  for (const float value : values.values()) rounded.push_back(static_cast<T>(std::lround(value)));
  zip.Write(rounded.data(), rounded.size() * sizeof(T));
}

void WriteImage(Zip& zip, const PolarImage& image, int bits) {
  switch (bits) {
    case 8:
      return WriteRounded<std::uint8_t>(zip, image.value);
    case 16:
      return WriteRounded<std::uint16_t>(zip, image.value);
    default:
      zip.Write(image.value.values().data(), image.value.size() * sizeof(float));
  }
}

std::vector<double> Matrix(const std::optional<Pose>& world_from_sonar) {
  std::vector<double> matrix(16, kNaN);
  if (!world_from_sonar) return matrix;
  const Eigen::Matrix3d rotation = world_from_sonar->rotation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) matrix[4 * row + col] = rotation(row, col);
    matrix[4 * row + 3] = world_from_sonar->position_m[row];
    matrix[12 + row] = 0.0;
  }
  matrix[15] = 1.0;
  return matrix;
}

void AddSmallArrays(Zip& zip, const RecordingSource& recording) {
  const RecordingInfo& info = recording.info();
  const PolarAxes& axes = info.sonar.axes;
  const auto frames = static_cast<std::size_t>(recording.frame_count());
  const auto bins = static_cast<std::size_t>(axes.range_bins);
  const std::size_t beams = axes.beam_azimuth_rad.size();
  std::vector<double> range_m;
  for (int bin = 0; bin < axes.range_bins; ++bin) range_m.push_back(axes.range_centre_m(bin));
  std::vector<double> azimuth_deg;
  for (const double azimuth_rad : axes.beam_azimuth_rad) azimuth_deg.push_back(DegFromRad(azimuth_rad));
  std::vector<double> time_s;
  std::vector<double> poses;
  for (int i = 0; i < recording.frame_count(); ++i) {
    const FrameInfo frame = recording.frame_info(i);
    time_s.push_back(frame.time_s.value_or(kNaN));
    const std::vector<double> matrix = Matrix(frame.world_from_sonar);
    poses.insert(poses.end(), matrix.begin(), matrix.end());
  }
  zip.Add("range_m", range_m, {bins});
  zip.Add("beam_azimuth_deg", azimuth_deg, {beams});
  zip.Add("time_s", time_s, {frames});
  zip.Add("world_from_sonar", poses, {frames, 4, 4});
  std::vector<std::uint8_t> valid(bins * beams, 1);
  if (info.valid) {
    for (std::size_t i = 0; i < valid.size(); ++i) valid[i] = info.valid->values()[i] != 0 ? 1 : 0;
  }
  zip.Begin("valid", "|b1", {bins, beams}, 1);
  zip.Write(valid.data(), valid.size());
  const std::string text =
      JsonText(RecordingJson({.info = info, .bits = MinBits(info.scale), .frames = {}}, "/"));
  zip.Begin("recording", fmt::format("|S{}", text.size()), {}, text.size());
  zip.Write(text.data(), text.size());
}

}  // namespace

void WriteNpz(const RecordingSource& recording, const std::filesystem::path& file,
              const std::function<void(int frames_done)>& progress) {
  const RecordingInfo& info = recording.info();
  const int bits = MinBits(info.scale);
  const char* const type = bits == 8 ? "|u1" : bits == 16 ? "<u2" : "<f4";
  Zip zip(file);
  AddSmallArrays(zip, recording);
  zip.Begin("images", type,
            {static_cast<std::size_t>(recording.frame_count()),
             static_cast<std::size_t>(info.sonar.axes.range_bins), info.sonar.axes.beam_azimuth_rad.size()},
            static_cast<std::size_t>(bits / 8));
  for (int i = 0; i < recording.frame_count(); ++i) {
    const Frame frame = recording.ReadFrame(i);
    CheckSameAsFirst(info, frame, i);
    CheckValues(frame.image, fmt::format("{}: frame {}", info.source, i));
    WriteImage(zip, frame.image, bits);
    if (progress) progress(i + 1);
  }
  zip.Close();
}

}  // namespace sonarcal::data_io
