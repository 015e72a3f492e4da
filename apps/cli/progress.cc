#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace sonarcal::cli {
namespace {

constexpr double kQuietStart_s = 1.0;
constexpr double kBarInterval_s = 0.1;
constexpr double kLineInterval_s = 5.0;
constexpr int kBarWidth = 24;

std::string DurationText(double duration_s) {
  const long seconds = std::lround(duration_s);
  if (seconds < 60) return fmt::format("{} s", seconds);
  if (seconds < 3600) return fmt::format("{} min {:02} s", seconds / 60, seconds % 60);
  return fmt::format("{} h {:02} min", seconds / 3600, seconds / 60 % 60);
}

}  // namespace

ProgressSettings ProgressSettings::Standard(bool quiet) {
  return {quiet ? nullptr : &std::cerr, isatty(STDERR_FILENO) != 0, [] {
            return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
          }};
}

Progress::Progress(std::string title, int total, ProgressSettings settings, std::string unit)
    : title_(std::move(title)), total_(total), settings_(std::move(settings)), unit_(std::move(unit)) {
  if (settings_.stream == nullptr) return;
  start_s_ = settings_.now_s();
  next_show_s_ = start_s_ + kQuietStart_s;
}

Progress::~Progress() {
  if (bar_drawn_) *settings_.stream << "\r\x1b[K" << std::flush;
}

void Progress::Show(int done) {
  if (settings_.stream == nullptr) return;
  // A thread never waits to show its progress: another one is showing it.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  const double now_s = settings_.now_s();
  if (now_s < next_show_s_ || (total_ > 0 && done >= total_)) return;
  const std::string status = StatusText(done, now_s - start_s_);
  if (settings_.terminal) {
    std::string bar;
    if (total_ > 0) {
      const int filled = std::clamp(kBarWidth * done / total_, 0, kBarWidth);
      bar = fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", kBarWidth - filled);
    }
    *settings_.stream << fmt::format("\r{}  {}{}\x1b[K", title_, bar, status) << std::flush;
    bar_drawn_ = true;
    next_show_s_ = now_s + kBarInterval_s;
  } else {
    *settings_.stream << fmt::format("sonarcal: {}: {}\n", title_, status) << std::flush;
    next_show_s_ = now_s + kLineInterval_s;
  }
}

std::string Progress::StatusText(int done, double elapsed_s) const {
  if (total_ <= 0) return fmt::format("{} done, {} so far", done, DurationText(elapsed_s));
  std::string text = fmt::format("{} of {}", done, total_);
  const int timed = done - skipped_;
  if (timed <= 0) return text;
  if (!unit_.empty()) text += fmt::format(", {:.3g} {}/s", timed / elapsed_s, unit_);
  return text + fmt::format(", {} left", DurationText(elapsed_s * (total_ - done) / timed));
}

}  // namespace sonarcal::cli
