// A fixture for formats of one file: a test makes up its bytes, and the program opens or refuses them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "data_io/open_recording.h"
#include "tests/data_io/hostile.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

class RecordingFileTest : public ::testing::Test {
 protected:
  explicit RecordingFileTest(const char* name) : path_(dir_ / name) {}

  std::unique_ptr<RecordingSource> Open(const std::string& bytes) {
    WriteFile(path_, bytes);
    return data_io::OpenRecording(path_);
  }
  // The sentence of the refusal; empty where all frames are read.
  std::string Refusal(const std::string& bytes) {
    WriteFile(path_, bytes);
    return RefusalOf(path_);
  }

  TempDir dir_;
  std::filesystem::path path_;
};

}  // namespace sonarcal::testing
