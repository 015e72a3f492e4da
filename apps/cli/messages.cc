#include "apps/cli/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>

#include "core/types/error.h"

namespace sonarcal::cli {
namespace {

// Never destroyed, because the thread that waits for signals may use it while the program ends.
struct Destinations {
  std::mutex mutex;
  MessageSettings settings;
  std::chrono::steady_clock::time_point start;
  std::ofstream log;
};

Destinations& Current() {
  static auto* destinations = new Destinations;
  return *destinations;
}

// Replaces line breaks. A sentence may quote user input, and a line break in it would make two sentences.
std::string OneLine(std::string_view sentence) {
  std::string text(sentence);
  std::ranges::replace_if(
      text, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string LocalTime() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm local = {};
  localtime_r(&now, &local);
  char text[32] = {};
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S%z", &local);
  return text;
}

// Needs the mutex.
void WriteToLog(Destinations& destinations, std::string_view line) {
  if (!destinations.log.is_open()) return;
  destinations.log << LocalTime() << ' ' << line << std::endl;
  if (destinations.log) return;
  destinations.log.close();
  std::cerr << "sonarcal: " << destinations.settings.log.string() << ": cannot be written any more"
            << std::endl;
}

}  // namespace

bool IsLog(const std::filesystem::path& file) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00";  // LocalTime() begins so
  std::ifstream stream(file, std::ios::binary);
  std::string begin(kForm.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (stream.gcount() == 0) return true;
  std::ranges::replace_if(
      begin, [](char c) { return c >= '0' && c <= '9'; }, '0');
  return begin == kForm;
}

void StartMessages(const MessageSettings& settings) {
  Destinations& destinations = Current();
  const std::lock_guard lock(destinations.mutex);
  destinations.settings = settings;
  destinations.start = std::chrono::steady_clock::now();
  destinations.log.close();
  if (settings.log.empty()) return;
  destinations.log.clear();
  destinations.log.open(settings.log, std::ios::app);
  if (!destinations.log)
    throw DataError("--log {}: cannot be written: {}", settings.log.string(),
                    std::generic_category().message(errno));
}

void PrintMessage(MessageKind kind, std::string_view sentence) {
  Destinations& destinations = Current();
  const std::lock_guard lock(destinations.mutex);
  const std::string line = OneLine(sentence);
  if (kind == MessageKind::kError) {
    std::cout.flush();  // keeps the order of results and errors on a common terminal
    std::cerr << "sonarcal: " << line << std::endl;
  } else if (destinations.settings.verbose) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - destinations.start;
    std::cerr << fmt::format("sonarcal: [{:7.2f} s] {}", elapsed.count(), sentence) << std::endl;
  } else if (kind == MessageKind::kNote) {
    std::cerr << "sonarcal: " << sentence << std::endl;
  }
  WriteToLog(destinations, kind == MessageKind::kError ? "error: " + line : line);
}

void PrintDetail(std::string_view sentence) {
  PrintMessage(MessageKind::kDetail, sentence);
}

void LogLine(std::string_view line) {
  Destinations& destinations = Current();
  const std::lock_guard lock(destinations.mutex);
  WriteToLog(destinations, OneLine(line));
}

bool HasLog() {
  Destinations& destinations = Current();
  const std::lock_guard lock(destinations.mutex);
  return destinations.log.is_open();
}

}  // namespace sonarcal::cli
