#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "apps/cli/messages.h"

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
  ProgressSettings settings{.stream = quiet ? nullptr : &std::cerr,
                            .terminal = isatty(STDERR_FILENO) != 0,
                            .now_s =
                                [] {
                                  const auto now = std::chrono::steady_clock::now().time_since_epoch();
                                  return std::chrono::duration<double>(now).count();
                                },
                            .detail = [](const std::string& sentence) { PrintDetail(sentence); }};
  if (HasLog()) settings.log = [](const std::string& line) { LogLine(line); };
  return settings;
}

Progress::Progress(std::string title, int total, ProgressSettings settings, std::string unit)
    : title_(std::move(title)), total_(total), settings_(std::move(settings)), unit_(std::move(unit)) {
  if (!settings_.now_s) return;  // shows and logs nothing
  start_s_ = settings_.now_s();
  next_show_s_ = start_s_ + kQuietStart_s;
  next_log_s_ = next_show_s_;
}

Progress::~Progress() {
  PrintDuration(done_);
  if (bar_drawn_) *settings_.stream << "\r\x1b[K" << std::flush;
}

void Progress::PrintDuration(int done) {
  if (!settings_.detail || has_printed_duration_.exchange(true)) return;
  {
    const std::lock_guard lock(mutex_);
    if (bar_drawn_) *settings_.stream << "\r\x1b[K" << std::flush;
    bar_drawn_ = false;
  }
  settings_.detail(fmt::format("{}: {} {} in {:.2f} s", title_, done, unit_.empty() ? "steps" : unit_,
                               settings_.now_s() - start_s_));
}

void Progress::Show(int done) {
  if (total_ > 0 && done >= total_) return PrintDuration(done);
  if (settings_.stream == nullptr && !settings_.log) return;
  // A thread never waits to show its progress: another one is showing it.
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  const double now_s = settings_.now_s();
  const bool shows = settings_.stream != nullptr && now_s >= next_show_s_;
  const bool logs = settings_.log && now_s >= next_log_s_;
  if (!shows && !logs) return;
  const std::string status = StatusText(done, now_s - start_s_);
  if (logs) {
    settings_.log(fmt::format("{}: {}", title_, status));
    next_log_s_ = now_s + kLineInterval_s;
  }
  if (!shows) return;
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
