// Adds the options of an options struct (core/types/option.h) to the command line: "region_range" becomes
// "--region-range".
//
//   workflow::RayOptions options;
//   AddOptions(*command, options);
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/workflow/comparison_options.h"
#include "calib/parameters/fit_config.h"
#include "core/text/nearest_word.h"
#include "core/types/frame_list.h"
#include "core/types/mask.h"
#include "core/types/option.h"
#include "core/types/option_text.h"
#include "core/types/parameters.h"

namespace sonarcal {

// Reads files while the command line is parsed. Throws DataError if a file cannot be used.
template <>
struct OptionText<FromFile<ParameterSet>> {
  static bool Parse(const std::string& text, FromFile<ParameterSet>& value);
  static std::string Format(const FromFile<ParameterSet>& value) { return value.file.string(); }
  static std::string Type(const OptionInfo&) { return "JSON"; }
  static constexpr const char* kExpected = "a file";
};

template <>
struct OptionText<FromFile<calib::FitConfig>> {
  static bool Parse(const std::string& text, FromFile<calib::FitConfig>& value);
  static std::string Format(const FromFile<calib::FitConfig>& value) { return value.file.string(); }
  static std::string Type(const OptionInfo&) { return "JSON"; }
  static constexpr const char* kExpected = "a file";
};

template <>
struct OptionText<FromFile<std::string>> {
  static bool Parse(const std::string& text, FromFile<std::string>& value);
  static std::string Format(const FromFile<std::string>& value) { return value.file.string(); }
  static std::string Type(const OptionInfo&) { return "JSON"; }
  static constexpr const char* kExpected = "a file";
};

template <>
struct OptionText<FromFile<Mask>> {
  static bool Parse(const std::string& text, FromFile<Mask>& value);
  static std::string Format(const FromFile<Mask>& value) { return value.file.string(); }
  static std::string Type(const OptionInfo&) { return "PNG"; }
  static constexpr const char* kExpected = "a file";
};

}  // namespace sonarcal

namespace sonarcal::cli {

// Converts "region_range" to "--region-range".
std::string OptionFlag(std::string_view name);

// Adds one option. `value` holds the default and receives the value.
template <typename T>
CLI::Option* AddOption(CLI::App& command, const OptionInfo& info, T& value) {
  const std::string flag = OptionFlag(info.name);
  const std::string help =
      info.by_default.empty() ? info.help : fmt::format("{} (default: {})", info.help, info.by_default);
  if constexpr (std::is_same_v<T, bool>) {
    return command.add_flag(flag, value, help);
  } else {
    const auto read = [flag, info, &value](const CLI::results_t& results) {
      T parsed{};
      if (!OptionText<T>::Parse(results.back(), parsed)) {
        throw CLI::ValidationError(
            fmt::format("{} {}", flag, UnknownWord(results.back(), OptionText<T>::kExpected)));
      }
      if (!IsWithin(info, parsed))
        throw CLI::ValidationError(fmt::format("{} {}{}", flag, results.back(), ExpectedNumberText(info)));
      value = std::move(parsed);
      return true;
    };
    const std::string type = info.type.empty() ? OptionText<T>::Type(info) : info.type;
    return command.add_option(flag, read, help)
        ->type_name(type)
        ->default_str(info.by_default.empty() ? OptionText<T>::Format(value) : std::string());
  }
}

// Adds all options of a struct. `options` must outlive the parsing.
template <typename Options>
void AddOptions(CLI::App& command, Options& options) {
  Options::Visit(options, [&](const OptionInfo& info, auto& value) { AddOption(command, info, value); });
}

// Adds only the option with this name. The name must be one of the struct's.
template <typename Options>
CLI::Option* AddOptionNamed(CLI::App& command, Options& options, std::string_view name) {
  CLI::Option* added = nullptr;
  Options::Visit(options, [&](const OptionInfo& info, auto& value) {
    if (info.name == name) added = AddOption(command, info, value);
  });
  return added;
}

// Check of an option without OptionInfo: a number within limits. CLI::Range lets NaN pass.
CLI::Validator Within(double least, double most);

// Adds --frames. `what` begins its help.
CLI::Option* AddFrames(CLI::App& command, FrameList& frames, const std::string& what);

// Returns all options by name, for provenance.
template <typename Options>
nlohmann::ordered_json OptionsJson(const Options& options) {
  nlohmann::ordered_json json;
  Options::Visit(options, [&](const OptionInfo& info, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::vector<std::string>>) {
      json[info.name] = value;
    } else if constexpr (std::is_same_v<T, FrameList>) {
      const std::optional<std::vector<int>> numbers = value.Numbers();
      json[info.name] = numbers ? nlohmann::ordered_json(*numbers) : nlohmann::ordered_json(value.Text());
    } else if (const std::string text = OptionText<T>::Format(value); !text.empty()) {
      json[info.name] = text;
    } else {
      json[info.name] = nullptr;
    }
  });
  return json;
}

// Returns the files that options name: those that were read as options, and lists of JSON files.
template <typename Options>
std::vector<std::filesystem::path> OptionFiles(const Options& options) {
  std::vector<std::filesystem::path> files;
  Options::Visit(options, [&](const OptionInfo& info, const auto& value) {
    if constexpr (requires { value.file; }) {
      if (!value.file.empty()) files.push_back(value.file);
    } else if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, std::vector<std::string>>) {
      if (info.type == "JSON") files.insert(files.end(), value.begin(), value.end());
    }
  });
  return files;
}

// Returns the words of a command line that set all options that differ from the default.
template <typename Options>
std::vector<std::string> OptionWords(const Options& options) {
  const Options by_default{};
  std::vector<std::string> defaults;
  Options::Visit(by_default, [&](const OptionInfo&, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    defaults.push_back(OptionText<T>::Format(value));
  });
  std::vector<std::string> words;
  std::size_t next = 0;
  Options::Visit(options, [&](const OptionInfo& info, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    const std::string text = OptionText<T>::Format(value);
    if (text == defaults.at(next++)) return;
    words.push_back(OptionFlag(info.name));
    if (!std::is_same_v<T, bool>) words.push_back(text);
  });
  return words;
}

}  // namespace sonarcal::cli
