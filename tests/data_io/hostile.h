// What every reader owes a hostile file: it opens, or DataError comes out. Anything else (another exception,
// a crash, a hang) fails the test.
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

#include "core/types/error.h"
#include "data_io/open_recording.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

// Opens `path`, reads all its frames, and returns whether that went well.
inline bool OpensWholly(const std::filesystem::path& path) {
  try {
    const auto recording = data_io::OpenRecording(path);
    for (int i = 0; i < recording->frame_count(); ++i) {
      recording->frame_info(i);
      const Frame frame = recording->ReadFrame(i);
      frame.image.axes.Validate("frame");
      EXPECT_EQ(frame.image.value.rows(), frame.image.axes.range_bins);
      EXPECT_EQ(frame.image.value.cols(), frame.image.axes.beam_count());
    }
    return true;
  } catch (const DataError& error) {
    EXPECT_FALSE(std::string_view(error.what()).empty());
    return false;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "something else than a DataError: " << error.what();
    return false;
  }
}

// The message of the DataError that opening `path` and reading its frames ends in; empty where all is well.
inline std::string RefusalOf(const std::filesystem::path& path) {
  try {
    const auto recording = data_io::OpenRecording(path);
    for (int i = 0; i < recording->frame_count(); ++i) recording->ReadFrame(i);
  } catch (const DataError& error) {
    return error.what();
  }
  return {};
}

// Writes `bytes`, cut short at many places and with random bytes changed, to `file` inside an otherwise
// complete recording, and opens `opened` (file or folder) each time. Leaves `file` as it was.
inline void ExpectOnlyDataErrors(const std::filesystem::path& opened, const std::filesystem::path& file,
                                 const std::string& bytes, std::size_t header_bytes) {
  for (std::size_t length = 0; length < bytes.size(); length += length < header_bytes ? 1 : 997) {
    WriteFile(file, bytes.substr(0, length));
    OpensWholly(opened);
  }
  for (unsigned seed = 1; seed <= 300; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes;
    const std::size_t reach = seed % 3 == 0 ? bytes.size() : std::min(bytes.size(), header_bytes);
    for (unsigned i = 0; i < 1 + seed % 8; ++i) damaged[random() % reach] = static_cast<char>(random());
    WriteFile(file, damaged);
    OpensWholly(opened);
  }
  WriteFile(file, bytes);
}

}  // namespace sonarcal::testing
