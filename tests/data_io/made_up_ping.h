// A small simple ping result of an Oculus, by its layout (data_io/sonars/oculus_io.h).
#pragma once

#include <cstdint>
#include <vector>

#include "tests/data_io/byte_writer.h"

namespace sonarcal::testing {

// A small ping; a test changes what it is about.
struct MadeUpPing {
  int version = 1;
  bool extended_flags = true;  // of version 2
  int ranges = 5;
  int beams = 4;
  int bytes_per_sample = 1;
  std::uint32_t gain = 0;  // of row 0, one more for each row after it; 0 = not sent
  std::uint8_t gamma = 127;
  double frequency_hz = 2.1e6;
  double temperature_c = 11.5;
  double pressure_bar = 1.2;
  double range_resolution_m = 0.01;
  double sound_speed_m_per_s = 1490.0;
  std::vector<std::int16_t> bearing_centideg = {-300, -90, 90, 300};

  static std::uint32_t Sample(int range, int beam, int bytes) {
    const auto low = static_cast<std::uint32_t>(10 * range + beam);
    return low | (bytes > 1 ? low << 8 * (bytes - 1) : 0);
  }
  std::size_t RowBytes() const { return std::size_t(beams) * bytes_per_sample + (gain > 0 ? 4 : 0); }
  std::size_t ResultOffset() const { return version == 2 && extended_flags ? 89 : 53; }
  std::size_t DataSizeOffset() const { return ResultOffset() + (version == 2 ? 72 : 44); }
  std::size_t ImageOffsetOffset() const { return ResultOffset() + (version == 2 ? 101 : 57); }
  std::size_t BearingsOffset() const { return ImageOffsetOffset() + 12; }
  std::size_t ImageOffset() const { return BearingsOffset() + 2 * std::size_t(beams) + 6; }

  ByteWriter Write() const {
    ByteWriter file;
    const std::size_t image_size = RowBytes() * ranges;
    const std::size_t message_size = ImageOffset() + image_size;
    file.U16(0, 0x4f53);
    file.U16(6, 0x23);
    file.U16(8, static_cast<std::uint16_t>(version == 2 ? 2 : 0));
    file.U32(10, static_cast<std::uint32_t>(message_size - 16));
    file.U8(16, 2);
    file.U8(19, gamma);
    file.U8(20, static_cast<std::uint8_t>(0x09 | (gain > 0 ? 0x04 : 0)));
    file.F64(21, 2.0);
    file.F64(29, 50.0);
    file.F64(45, 0.5);
    const std::size_t result = ResultOffset();
    file.U32(result, 77);
    file.F64(result + 8, frequency_hz);
    file.F64(result + 16, temperature_c);
    file.F64(result + 24, pressure_bar);
    if (version == 2) {
      file.F64(result + 32, 123.0);  // heading
      file.F64(result + 56, sound_speed_m_per_s);
      file.F64(result + 64, 12.25);  // start
    } else {
      file.F64(result + 32, sound_speed_m_per_s);
    }
    file.U8(DataSizeOffset(), static_cast<std::uint8_t>(bytes_per_sample - 1));
    file.F64(DataSizeOffset() + 1, range_resolution_m);
    file.U16(DataSizeOffset() + 9, static_cast<std::uint16_t>(ranges));
    file.U16(DataSizeOffset() + 11, static_cast<std::uint16_t>(beams));
    file.U32(ImageOffsetOffset(), static_cast<std::uint32_t>(ImageOffset()));
    file.U32(ImageOffsetOffset() + 4, static_cast<std::uint32_t>(image_size));
    file.U32(ImageOffsetOffset() + 8, static_cast<std::uint32_t>(message_size));
    for (std::size_t i = 0; i < bearing_centideg.size(); ++i) {
      file.I16(BearingsOffset() + 2 * i, bearing_centideg[i]);
    }
    file.Grow(message_size);
    for (int range = 0; range < ranges; ++range) {
      std::size_t at = ImageOffset() + RowBytes() * range;
      if (gain > 0) {
        file.U32(at, gain + range);
        at += 4;
      }
      for (int beam = 0; beam < beams; ++beam) {
        const std::uint32_t sample = Sample(range, beam, bytes_per_sample);
        for (int i = 0; i < bytes_per_sample; ++i, ++at) {
          file.U8(at, static_cast<std::uint8_t>(sample >> 8 * i));
        }
      }
    }
    return file;
  }
};

}  // namespace sonarcal::testing
