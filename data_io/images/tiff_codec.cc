#include "data_io/images/tiff_codec.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/types/error.h"
#include "core/types/printable.h"

namespace sonarcal::data_io {
namespace {

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffHandle = std::unique_ptr<TIFF, CloseTiff>;

// A file in memory that libtiff reads through callbacks.
struct MemoryFile {
  std::string_view bytes;
  std::uint64_t position = 0;
  char message[256] = {};  // first error message of libtiff
};

MemoryFile& File(thandle_t handle) {
  return *static_cast<MemoryFile*>(handle);
}

tmsize_t ReadBytes(thandle_t handle, void* target, tmsize_t count) {
  MemoryFile& file = File(handle);
  if (count <= 0 || file.position >= file.bytes.size()) return 0;
  const std::size_t available = std::min<std::size_t>(count, file.bytes.size() - file.position);
  std::memcpy(target, file.bytes.data() + file.position, available);
  file.position += available;
  return static_cast<tmsize_t>(available);
}

tmsize_t WriteNothing(thandle_t, void*, tmsize_t) {
  return 0;
}

toff_t Seek(thandle_t handle, toff_t offset, int whence) {
  MemoryFile& file = File(handle);
  const std::uint64_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? file.position : file.bytes.size();
  return file.position = from + offset;
}

int CloseNothing(thandle_t) {
  return 0;
}
toff_t Size(thandle_t handle) {
  return File(handle).bytes.size();
}

// Gives libtiff the bytes themselves, so that it does not allocate a buffer of a length claimed by the file.
int Map(thandle_t handle, void** base, toff_t* size) {
  *base = const_cast<char*>(File(handle).bytes.data());
  *size = File(handle).bytes.size();
  return 1;
}
void UnmapNothing(thandle_t, void*, toff_t) {}

int KeepFirstMessage(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  auto* file = static_cast<MemoryFile*>(user);
  if (file->message[0] == '\0') std::vsnprintf(file->message, sizeof(file->message), format, arguments);
  return 1;
}
int DropMessage(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

TiffHandle Open(MemoryFile& file) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, KeepFirstMessage, &file);
  TIFFOpenOptionsSetWarningHandlerExtR(options, DropMessage, nullptr);
  TiffHandle tiff(TIFFClientOpenExt("", "r", &file, ReadBytes, WriteNothing, Seek, CloseNothing, Size, Map,
                                    UnmapNothing, options));
  TIFFOpenOptionsFree(options);
  return tiff;
}

template <typename T>
T Field(TIFF* tiff, std::uint32_t tag, T absent = T{}) {
  T value = absent;
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : absent;
}

class TiffReader {
 public:
  TiffReader(std::string_view bytes, const std::string& name) : file_{.bytes = bytes}, name_(name) {
    tiff_ = Open(file_);
    if (tiff_ == nullptr) FailDamaged();
    header_ = {.rows = SizeField(TIFFTAG_IMAGELENGTH),
               .cols = SizeField(TIFFTAG_IMAGEWIDTH),
               .channels = Field<std::uint16_t>(tiff_.get(), TIFFTAG_SAMPLESPERPIXEL),
               .bits = Field<std::uint16_t>(tiff_.get(), TIFFTAG_BITSPERSAMPLE),
               .is_float = SampleFormat() == SAMPLEFORMAT_IEEEFP};
    CheckImageHeader(header_, bytes.size(), name_);
    CheckPlain();
  }

  const ImageHeader& header() const { return header_; }

  std::vector<std::byte> Decode() {
    const bool known = header_.is_float ? header_.bits == 32 : header_.bits == 8 || header_.bits == 16;
    if (!known || header_.channels != 1 || (!header_.is_float && SampleFormat() != SAMPLEFORMAT_UINT)) {
      throw DataError("{}: {}, expected grey of 8 or 16 bits or 32-bit float", name_, header_.Describe());
    }
    const std::size_t row_bytes = header_.row_bytes();
    std::vector<std::byte> decoded(row_bytes * header_.rows);
    for (int row = 0; row < header_.rows; ++row) {
      if (TIFFReadScanline(tiff_.get(), &decoded[row * row_bytes], row) != 1) FailDamaged();
    }
    return decoded;
  }

 private:
  int SizeField(std::uint32_t tag) const {
    return static_cast<int>(std::min<std::uint32_t>(Field<std::uint32_t>(tiff_.get(), tag), 1U << 30));
  }
  std::uint16_t SampleFormat() const {
    return Field<std::uint16_t>(tiff_.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  }

  void CheckPlain() const {
    if (TIFFIsTiled(tiff_.get()) != 0) throw DataError("{}: a tiled TIFF, expected one in strips", name_);
    if (TIFFLastDirectory(tiff_.get()) == 0) {
      throw DataError("{}: a TIFF of several images, expected one", name_);
    }
    const auto compression = Field<std::uint16_t>(tiff_.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    constexpr std::uint16_t kKnown[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE,
                                        COMPRESSION_DEFLATE, COMPRESSION_PACKBITS};
    if (std::find(std::begin(kKnown), std::end(kKnown), compression) == std::end(kKnown)) {
      throw DataError("{}: TIFF compression {}, expected none, LZW, deflate or PackBits", name_, compression);
    }
    const auto meaning = Field<std::uint16_t>(tiff_.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    if (header_.channels == 1 && meaning != PHOTOMETRIC_MINISBLACK) {
      throw DataError("{}: TIFF photometric interpretation {}, expected {} (grey, 0 is black)", name_,
                      meaning, PHOTOMETRIC_MINISBLACK);
    }
  }

  [[noreturn]] void FailDamaged() const {
    throw DataError("{}: damaged TIFF: {}", name_,
                    file_.message[0] != '\0' ? Printable(file_.message) : "it cannot be opened");
  }

  MemoryFile file_;  // declared before tiff_, which refers to it
  TiffHandle tiff_;
  std::string name_;
  ImageHeader header_;
};

}  // namespace

bool IsTiff(std::string_view bytes) {
  using namespace std::string_view_literals;
  return bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv);
}

ImageHeader ReadTiffHeader(std::string_view bytes, const std::string& file) {
  return TiffReader(bytes, file).header();
}

std::vector<std::byte> DecodeTiff(std::string_view bytes, const std::string& file) {
  return TiffReader(bytes, file).Decode();
}

std::vector<std::uint8_t> EncodeFloatTiff(int rows, int cols, std::span<const float> samples) {
  SONARCAL_CHECK(rows > 0 && cols > 0 && samples.size() == static_cast<std::size_t>(rows) * cols,
                 "{} samples for {} x {}", samples.size(), rows, cols);
  const cv::Mat image(rows, cols, CV_32FC1, const_cast<float*>(samples.data()));
  std::vector<std::uint8_t> encoded;
  const bool done = cv::imencode(".tiff", image, encoded, {cv::IMWRITE_TIFF_COMPRESSION, COMPRESSION_NONE});
  SONARCAL_CHECK(done, "OpenCV does not encode a float TIFF");
  return encoded;
}

}  // namespace sonarcal::data_io
