// --sonar, for every command that takes a sonar.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "sim/scenes/sonar_presets.h"

namespace sonarcal::cli {

// Adds --sonar. `note`: appended to the description, such as " (default: that of --real)".
inline CLI::Option* AddSonar(CLI::App& command, std::string& sonar, const std::string& note = {}) {
  return command
      .add_option(
          "--sonar", sonar,
          "Sonar: a name such as p900-45 (listed by sonarcal sonars), a recording, or a JSON file with a "
          "'sonar' object" +
              note)
      ->type_name("NAME|FILE");
}

// Adds --sonar of a command that reads a recording.
inline CLI::Option* AddSonarOfRecording(CLI::App& command, std::string& sonar) {
  return AddSonar(command, sonar,
                  ", such as the calibrated one, in place of that of the recording (default: as recorded)");
}

// Returns the file that --sonar names; empty for a preset and without the option.
inline std::filesystem::path SonarFile(const std::string& sonar) {
  const bool is_preset = std::ranges::any_of(
      sim::SonarPresets(), [&](const sim::SonarPreset& preset) { return preset.name == sonar; });
  return is_preset ? std::filesystem::path() : std::filesystem::path(sonar);
}

}  // namespace sonarcal::cli
