// Reads JSON documents by the readers of the program, many in one process. Prints the sentence of each
// refusal, which begins with the file.
//
//   sonarcal_read_documents params|fit_config|poses|materials FILE...
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "calib/parameters/fit_config.h"
#include "core/types/error.h"
#include "data_io/parameters/materials_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"

int main(int argc, char** argv) {
  using sonarcal::DataError;
  const std::map<std::string, std::function<void(const std::filesystem::path&)>> readers = {
      {"params", [](const auto& file) { sonarcal::data_io::ReadParameters(file); }},
      {"fit_config", [](const auto& file) { sonarcal::calib::ReadFitConfig(file); }},
      {"poses", [](const auto& file) { sonarcal::data_io::ReadPosesOrRecording(file); }},
      {"materials", [](const auto& file) { sonarcal::data_io::ReadMaterials(file); }}};
  const auto reader = argc > 1 ? readers.find(argv[1]) : readers.end();
  if (reader == readers.end()) {
    std::fprintf(stderr, "usage: %s params|fit_config|poses|materials FILE...\n", argv[0]);
    return 2;
  }
  for (int i = 2; i < argc; ++i) {
    try {
      reader->second(argv[i]);
    } catch (const DataError& error) {
      std::printf("%s\n", error.what());
    }
  }
  return 0;
}
