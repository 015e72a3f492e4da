// A world small enough to simulate, compare and fit in a moment, as files: for tests of commands.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

// A box on a floor, a sonar of 24 beams x 60 bins that looks at it from four places.
class TinyWorld {
 public:
  TinyWorld();

  std::filesystem::path operator/(const std::string& name) const { return dir_ / name; }
  std::filesystem::path scene() const { return dir_ / "scene.gltf"; }
  std::filesystem::path sonar() const { return dir_ / "sonar.json"; }
  std::filesystem::path params() const { return dir_ / "params.json"; }  // as the recordings below are made
  std::filesystem::path poses() const { return dir_ / "poses.json"; }

  // Options of `simulate` (without --out), each path quoted for a shell.
  std::string SimulateArguments() const;

  // A recording made in the world, written to a folder: without noise, with it, or expected images.
  std::filesystem::path WriteSimulated(const std::string& name, bool noise = false,
                                       bool expected = false) const;

 private:
  TempDir dir_;
};

ParameterSet TinyParameters();
ParameterSet TinyAcousticParameters();  // the same world as the acoustic model has it

nlohmann::json ReadJsonFile(const std::filesystem::path& file);

// "sonarcal: ..." and one line.
bool IsOneSentence(const std::string& text);

}  // namespace sonarcal::testing
