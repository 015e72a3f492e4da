// Messages of sonars for tests; a test changes what it is about.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/data_io/message_writer.h"

namespace sonarcal::testing {

// 3 beams at -30, 0 and 30 degrees, 4 ranges of 0.5 m from 2 m on. Sample (bin, beam) is 10 bin + beam + 1.
struct MadeUpProjected {
  std::uint32_t seconds = 1'700'000'000;
  std::uint32_t nanoseconds = 250'000'000;
  std::string frame_id = "sonar";
  std::vector<float> tx = {0.2F, 0.4F};  // 0.3 rad in the mean
  std::vector<float> rx = {0.01F};
  std::vector<double> azimuth_deg = {-30.0, 0.0, 30.0};
  bool along_x = false;  // beams about X, as simulators write
  std::vector<float> range_m = {2.25F, 2.75F, 3.25F, 3.75F};
  bool data_big_endian = false;
  std::uint32_t type = 0;
  std::uint32_t beam_count = 3;
  bool by_range = false;
  int add = 1;
  bool blob = false;  // an echo about bin 10 and beam 6 instead
  float frequency_hz = 1.2e6F;

  double Sample(std::size_t bin, std::size_t beam) const {
    if (blob) {
      const double bins_off = static_cast<double>(bin) - 10.0;
      const double beams_off = static_cast<double>(beam) - 6.0;
      return std::floor(200.0 * std::exp(-(bins_off * bins_off + beams_off * beams_off) / 18.0));
    }
    return static_cast<double>(10 * bin + beam) + add;
  }

  std::string Data() const {
    std::string data;
    const std::size_t beams = azimuth_deg.size();
    for (std::size_t i = 0; i < beams * range_m.size(); ++i) {
      const double sample =
          by_range ? Sample(i / beams, i % beams) : Sample(i % range_m.size(), i / range_m.size());
      // The bits of the sample in its type, least byte first.
      MessageWriter little(Wire::kRos1);
      switch (type) {
        case 0:
        case 1:
          little.U8(static_cast<std::uint8_t>(sample));
          break;
        case 2:
        case 3:
          little.U16(static_cast<std::uint16_t>(sample));
          break;
        case 4:
        case 5:
          little.U32(static_cast<std::uint32_t>(sample));
          break;
        case 6:
        case 7:
          little.U64(static_cast<std::uint64_t>(sample));
          break;
        case 8:
          little.F32(static_cast<float>(sample));
          break;
        default:
          little.F64(sample);
      }
      const std::string& bytes = little.bytes();
      data += data_big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
    }
    return data;
  }

  std::string Write(Wire wire) const {
    MessageWriter message(wire);
    message.Header(seconds, nanoseconds, frame_id).F32(frequency_hz).F32(1480.0F).F32s(tx).F32s(rx);
    message.U32(static_cast<std::uint32_t>(azimuth_deg.size()));
    for (const double azimuth : azimuth_deg) {
      const double angle_rad = azimuth * 3.14159265358979323846 / 180.0;
      if (along_x) {
        message.F64(std::cos(angle_rad)).F64(-std::sin(angle_rad)).F64(0.0);
      } else {
        message.F64(0.0).F64(std::sin(angle_rad)).F64(std::cos(angle_rad));
      }
    }
    message.F32s(range_m).U8(data_big_endian ? 1 : 0).U32(type).U32(beam_count).Blob(Data());
    return message.bytes();
  }
};

// 4 ranges of 0.25 m, 3 beams. Pixel (row, col) is 20 row + col.
struct MadeUpOculusPing {
  enum class Layout { kImageFirst, kCompressedLast, kImageLast };
  Layout layout = Layout::kImageFirst;
  std::uint32_t seconds = 1'600'000'000;
  std::vector<std::int16_t> bearings = {-1000, 0, 1500};
  std::uint32_t ranges = 4;
  std::uint32_t beams = 3;
  std::uint32_t width = 3;
  std::string encoding = "mono8";
  std::uint32_t row_bytes = 4;  // a byte of padding
  std::uint8_t flags = 1;
  std::string compressed = {};  // a PNG or JPEG
  std::string compressed_format = "mono8; png compressed ";

  void Image(MessageWriter& message) const {
    std::string data;
    for (std::uint32_t row = 0; row < ranges; ++row) {
      for (std::uint32_t col = 0; col < row_bytes; ++col)
        data += static_cast<char>(col < width ? 20 * row + col : 255);
    }
    message.Header(seconds, 0, "sonar")
        .U32(ranges)
        .U32(width)
        .String(encoding)
        .U8(0)
        .U32(row_bytes)
        .Blob(data);
  }

  std::string Write(Wire wire) const {
    MessageWriter message(wire);
    message.Header(seconds, 500'000'000, "oculus");
    if (layout == Layout::kImageFirst) Image(message);
    message.Header(seconds, 0, "fire").U8(2).U8(127).U8(flags).F64(10.0).F64(35.0).F64(1490.0).F64(0.5);
    message.U32(99);
    if (layout == Layout::kImageFirst) {
      message.U32(0).F64(2.1e6).F64(12.5).F64(1.75).F64(1466.0);
    } else {
      message.U16(1042);
    }
    message.U32(0).U32(static_cast<std::uint32_t>(bearings.size()));
    for (const std::int16_t bearing : bearings) message.U16(static_cast<std::uint16_t>(bearing));
    message.F64(0.25).U32(ranges).U32(beams);
    if (layout == Layout::kImageLast) Image(message);
    if (layout == Layout::kCompressedLast)
      message.Header(seconds, 0, "sonar").String(compressed_format).Blob(compressed);
    return message.bytes();
  }
};

}  // namespace sonarcal::testing
