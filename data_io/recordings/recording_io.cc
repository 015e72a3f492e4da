#include "data_io/recordings/recording_io.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "data_io/images/image_io.h"
#include "data_io/json/json_writer.h"
#include "data_io/recordings/frame_storage.h"
#include "data_io/recordings/recording_json.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

ImageHeader GreyHeader(const PolarAxes& axes, int bits) {
  return {.rows = axes.range_bins,
          .cols = axes.beam_count(),
          .channels = 1,
          .bits = bits,
          .is_float = bits == 32};
}

// Size and type are checked before decoding.
Grid<float> ReadImage(const fs::path& file, const ImageHeader& expected) {
  const ImageFile image(file);
  if (image.header() != expected) {
    throw DataError("{}: {}, expected {} as in {}", file.string(), image.header().Describe(),
                    expected.Describe(), kRecordingFile);
  }
  return image.DecodeGrey();
}

Mask ReadValid(const fs::path& file, const PolarAxes& axes) {
  const Grid<float> grey = ReadImage(file, GreyHeader(axes, 8));
  Mask valid(grey.rows(), grey.cols());
  std::transform(grey.values().begin(), grey.values().end(), valid.values().begin(),
                 [](float value) { return std::uint8_t{value > 0.0F}; });
  if (CountSet(valid) == 0) throw DataError("{}: no sample is valid, expected some", file.string());
  return valid;
}

void WriteValid(const fs::path& file, const Mask& valid) {
  constexpr std::uint8_t kWhite = 255;
  Grid<std::uint8_t> shown(valid.rows(), valid.cols());
  std::transform(valid.values().begin(), valid.values().end(), shown.values().begin(),
                 [](std::uint8_t set) { return set != 0 ? kWhite : std::uint8_t{0}; });
  WritePng(file, shown);
}

class RecordingFolder final : public RecordingSource {
 public:
  RecordingFolder(const fs::path& folder, fs::path images)
      : images_(std::move(images)), header_(ReadRecordingHeader(folder)) {
    header_.info.source = images_.string();
    if (!header_.valid_file.empty())
      header_.info.valid = ReadValid(images_ / header_.valid_file, header_.info.sonar.axes);
  }

  const RecordingInfo& info() const override { return header_.info; }
  int frame_count() const override { return static_cast<int>(header_.frames.size()); }
  FrameInfo frame_info(int index) const override { return header_.frames.at(index); }

  Frame ReadFrame(int index) const override {
    Frame frame;
    frame.info = frame_info(index);
    const fs::path file = images_ / frame.info.name;
    const PolarAxes& axes = header_.info.sonar.axes;
    frame.image = {axes, header_.info.scale, ReadImage(file, GreyHeader(axes, header_.bits))};
    CheckValues(frame.image, file.string());
    return frame;
  }

 private:
  fs::path images_;
  RecordingHeader header_;
};

int ChooseBits(const RecordingSource& recording, int asked) {
  const ImageScale& scale = recording.info().scale;
  SONARCAL_CHECK(asked == 0 || asked == 8 || asked == 16 || asked == 32, "{} bits", asked);
  const int min_bits = MinBits(scale);
  if (asked == 0) return min_bits;
  if (asked < min_bits) {
    throw DataError("{}: {} images with full scale {} do not fit {} bits, expected {}",
                    recording.info().source, ToString(scale.quantity), scale.full_scale, asked, min_bits);
  }
  return asked;
}

template <typename T>
Grid<T> Rounded(const Grid<float>& value) {
  Grid<T> rounded(value.rows(), value.cols());
  std::transform(value.values().begin(), value.values().end(), rounded.values().begin(),
                 [](float v) { return static_cast<T>(std::lround(v)); });
  return rounded;
}

void WriteImage(const fs::path& file, const Grid<float>& value, int bits) {
  if (bits == 8) return WritePng(file, Rounded<std::uint8_t>(value));
  if (bits == 16) return WritePng(file, Rounded<std::uint16_t>(value));
  WriteTiff(file, value);
}

std::string ImageName(int index, int bits) {
  return fmt::format("frame_{:04}.{}", index, bits == 32 ? "tiff" : "png");
}

bool HoldsFractions(const Grid<float>& value) {
  return std::ranges::any_of(value.values(), [](float v) { return v != std::round(v); });
}

// Replaces the images so far, which hold whole numbers, by float images.
void Widen(RecordingHeader& header, const OutputDirectory& output) {
  const ImageHeader narrow = GreyHeader(header.info.sonar.axes, header.bits);
  header.bits = 32;
  for (FrameInfo& frame : header.frames) {
    const fs::path old = output / frame.name;
    frame.name = fs::path(frame.name).replace_extension("tiff").string();
    WriteTiff(output / frame.name, ReadImage(old, narrow));
    std::error_code ignored;
    fs::remove(old, ignored);
  }
}

// Refuses before the first frame what no command could read, rather than after hours of work.
void CheckThatItCanBeRead(RecordingHeader header, const RecordingSource& recording, const fs::path& folder) {
  for (int index = 0; index < recording.frame_count(); ++index) {
    header.frames.push_back(recording.frame_info(index));
    header.frames.back().name = ImageName(index, header.bits);
  }
  try {
    ParseRecordingHeader(JsonText(RecordingJson(header, folder)), folder);
  } catch (const DataError& refusal) {
    throw DataError("{}: cannot be written, because no command could read it: {}", header.info.source,
                    refusal.what());
  }
}

}  // namespace

bool IsRecordingFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path.filename() == kRecordingFile ? path : path / kRecordingFile, error);
}

std::unique_ptr<RecordingSource> OpenRecordingFolder(const fs::path& path) {
  if (path.filename() != kRecordingFile) return std::make_unique<RecordingFolder>(path, path);
  const fs::path parent = path.parent_path();
  const fs::path folder = parent.empty() ? "." : parent;
  return std::make_unique<RecordingFolder>(folder, folder);
}

std::unique_ptr<RecordingSource> OpenRecordingOf(const fs::path& images, const fs::path& folder) {
  return std::make_unique<RecordingFolder>(folder, images);
}

void WriteRecording(const RecordingSource& recording, const fs::path& folder,
                    const WriteRecordingOptions& options) {
  OutputDirectory output(folder);
  if (WriteRecording(recording, output, options) == 0) return;
  if (IsRecordingFolder(folder)) {
    output.Replace([] { return std::set<fs::path>(); });
  } else {
    output.Commit();
  }
}

int WriteRecording(const RecordingSource& recording, const OutputDirectory& output,
                   const WriteRecordingOptions& options) {
  const int frame_count = recording.frame_count();
  if (frame_count == 0) throw DataError("{}: no frames, expected at least one", recording.info().source);
  RecordingHeader header{recording.info(), ChooseBits(recording, options.bits), {}};
  header.info.sonar.axes.Validate(header.info.source);
  CheckThatItCanBeRead(header, recording, output.final_path());
  bool stopped = false;
  for (int index = 0; index < frame_count; ++index) {
    if (const std::string file = ImageName(index, header.bits);
        options.is_written && options.is_written(index, file)) {
      header.frames.push_back(recording.frame_info(index));
      header.frames.back().name = file;
      continue;
    }
    stopped = stopped || (options.stop && options.stop());
    if (stopped) continue;
    const Frame frame = recording.ReadFrame(index);
    CheckSameAsFirst(header.info, frame, index);
    CheckValues(frame.image, fmt::format("{}: frame {}", header.info.source, index));
    if (options.bits == 0 && header.bits < 32 && HoldsFractions(frame.image.value)) Widen(header, output);
    header.frames.push_back(frame.info);
    header.frames.back().name = ImageName(index, header.bits);
    WriteImage(output / header.frames.back().name, frame.image.value, header.bits);
    if (options.progress) options.progress(static_cast<int>(header.frames.size()), frame_count);
  }
  const auto frames_done = static_cast<int>(header.frames.size());
  if (frames_done == 0) return 0;
  if (header.info.valid) {
    header.valid_file = "valid.png";
    WriteValid(output / header.valid_file, *header.info.valid);
  }
  if (frames_done < frame_count) {
    header.info.notes.push_back(fmt::format("unfinished: {} of {} frames", frames_done, frame_count));
  }
  WriteJson(output / kRecordingFile, RecordingJson(header, output.final_path()));
  return frames_done;
}

}  // namespace sonarcal::data_io
