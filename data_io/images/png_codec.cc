#include "data_io/images/png_codec.h"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

constexpr int kBytesOfSignature = 8;

// libpng reports an error by a jump, which must not skip destructors. Every call therefore goes through
// Guard(). Its action holds only plain data and references, and the exception is thrown after the jump.
// Warnings (e.g. about a damaged comment) are ignored because they do not concern the pixels.
class PngSession {
 public:
  PngSession() = default;
  PngSession(const PngSession&) = delete;
  PngSession& operator=(const PngSession&) = delete;

 protected:
  ~PngSession() = default;

  template <typename Action>
  void Guard(const std::string& what, const Action& action) {
    if (setjmp(png_jmpbuf(png_)) != 0) throw DataError("{}: {}", what, message_);
    action();
  }

  static void OnError(png_structp png, png_const_charp message) {
    auto* session = static_cast<PngSession*>(png_get_error_ptr(png));
    std::snprintf(session->message_, sizeof(session->message_), "%s", message);
    std::longjmp(png_jmpbuf(png), 1);
  }
  static void OnWarning(png_structp, png_const_charp) {}

  png_structp png_ = nullptr;
  png_infop info_ = nullptr;

 private:
  char message_[128] = {};
};

class PngReader : PngSession {
 public:
  PngReader(std::string_view bytes, const std::string& file) : rest_(bytes), what_(file + ": damaged PNG") {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, static_cast<PngSession*>(this), OnError, OnWarning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, this, ReadBytes);
    try {
      Guard(what_, [this] { png_read_info(png_, info_); });
      CheckImageHeader(StoredHeader(), bytes.size(), file);
    } catch (...) {
      png_destroy_read_struct(&png_, &info_, nullptr);  // no destructor runs if a constructor throws
      throw;
    }
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  ImageHeader Header() const {
    ImageHeader header = StoredHeader();
    if (png_get_color_type(png_, info_) == PNG_COLOR_TYPE_PALETTE) {
      header.channels = 3;
      header.bits = 8;
    }
    return header;
  }

  std::vector<std::byte> Decode(PngSamples samples) {
    Guard(what_, [this, samples] {
      if (samples == PngSamples::kRgb8) {
        png_set_expand(png_);
        png_set_strip_16(png_);
        png_set_strip_alpha(png_);
        png_set_gray_to_rgb(png_);
      } else if (std::endian::native == std::endian::little && png_get_bit_depth(png_, info_) == 16) {
        png_set_swap(png_);
      }
      png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
    });
    const std::size_t row_bytes = png_get_rowbytes(png_, info_);
    std::vector<std::byte> decoded(row_bytes * png_get_image_height(png_, info_));
    std::vector<png_bytep> rows;
    for (std::size_t begin = 0; begin < decoded.size(); begin += row_bytes) {
      rows.push_back(reinterpret_cast<png_bytep>(&decoded[begin]));
    }
    Guard(what_, [this, &rows] {
      png_read_image(png_, rows.data());
      png_read_end(png_, nullptr);  // detects a file truncated after its pixels
    });
    return decoded;
  }

 private:
  // The samples in the file; those of a palette are indices of 1 to 8 bits.
  ImageHeader StoredHeader() const {
    return {.rows = static_cast<int>(png_get_image_height(png_, info_)),
            .cols = static_cast<int>(png_get_image_width(png_, info_)),
            .channels = png_get_channels(png_, info_),
            .bits = png_get_bit_depth(png_, info_)};
  }

  static void ReadBytes(png_structp png, png_bytep target, std::size_t count) {
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->rest_.size()) png_error(png, "it ends early");
    std::memcpy(target, reader->rest_.data(), count);
    reader->rest_.remove_prefix(count);
  }

  std::string_view rest_;
  std::string what_;
};

class PngWriter : PngSession {
 public:
  PngWriter() {
    png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, static_cast<PngSession*>(this), OnError, OnWarning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ == nullptr) {
      png_destroy_write_struct(&png_, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png_, &encoded_, WriteBytes, nullptr);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  std::vector<std::uint8_t> Encode(const ImageHeader& header, std::span<const std::byte> samples) {
    std::vector<png_bytep> rows;
    for (int row = 0; row < header.rows; ++row) {
      const std::byte* begin = samples.data() + row * header.row_bytes();
      rows.push_back(reinterpret_cast<png_bytep>(const_cast<std::byte*>(begin)));
    }
    Guard("cannot make a PNG", [&] {
      png_set_IHDR(png_, info_, header.cols, header.rows, header.bits,
                   header.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                   PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
      png_write_info(png_, info_);
      if (std::endian::native == std::endian::little && header.bits == 16) png_set_swap(png_);
      png_write_image(png_, rows.data());
      png_write_end(png_, nullptr);
    });
    return std::move(encoded_);
  }

 private:
  static void WriteBytes(png_structp png, png_bytep bytes, std::size_t count) {
    auto* encoded = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
    encoded->insert(encoded->end(), bytes, bytes + count);
  }

  std::vector<std::uint8_t> encoded_;
};

}  // namespace

bool IsPng(std::string_view bytes) {
  return bytes.size() >= kBytesOfSignature &&
         png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, kBytesOfSignature) == 0;
}

ImageHeader ReadPngHeader(std::string_view bytes, const std::string& file) {
  return PngReader(bytes, file).Header();
}

std::vector<std::byte> DecodePng(std::string_view bytes, PngSamples samples, const std::string& file) {
  return PngReader(bytes, file).Decode(samples);
}

std::vector<std::uint8_t> EncodePngSamples(const ImageHeader& header, std::span<const std::byte> samples) {
  SONARCAL_CHECK(header.channels == 1 || header.channels == 3, "{} channels", header.channels);
  SONARCAL_CHECK(header.bits == 8 || header.bits == 16, "{} bits", header.bits);
  SONARCAL_CHECK(header.pixels() > 0 && samples.size() == header.row_bytes() * header.rows, "{} bytes for {}",
                 samples.size(), header.Describe());
  return PngWriter().Encode(header, samples);
}

}  // namespace sonarcal::data_io
