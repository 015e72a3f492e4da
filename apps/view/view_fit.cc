#include "apps/view/view_fit.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <exception>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLinesKept = 40;

Json FiguresJson(const metrics::MetricsReport& report) {
  const auto value = [](const metrics::Statistic& statistic) {
    return statistic.value ? Json(*statistic.value) : Json(nullptr);
  };
  const metrics::Aggregate::Views& macro = report.aggregate.macro;
  const metrics::IntensityDomain domain = report.options.intensity_domain;
  return {{"intensity_error", value(macro.polar.Over(domain).mean_absolute)},
          {"intensity_error_whole", value(macro.polar.Over(metrics::IntensityDomain::kWhole).mean_absolute)},
          {"iou", value(macro.polar.At("iou"))}};
}

// {"parameters": {params.json}, "fitted": [{"name", "initial", "value", "sigma", "unit", "status"}],
//  "warnings": [...], "left_open": [...], "frames_used", "frames_held_out", "judged_on_held_out", "before":
//  FIGURES, "after": FIGURES}
Json ResultJson(const workflow::RecordingFit& fit) {
  const calib::FitReport& report = fit.fit.report;
  Json fitted = Json::array();
  for (const calib::FittedParameter& p : report.parameters) {
    if (p.status == calib::ParameterStatus::kFixed) continue;
    fitted.push_back({{"name", p.name},
                      {"initial", p.initial},
                      {"value", p.value},
                      {"sigma", p.sigma ? Json(*p.sigma) : Json(nullptr)},
                      {"unit", p.unit},
                      {"status", ToString(p.status)}});
  }
  return {{"parameters", data_io::ParametersJson(fit.fit.parameters)},
          {"fitted", std::move(fitted)},
          {"warnings", report.warnings},
          {"left_open", report.unidentifiable_directions},
          {"frames_used", report.frames_used},
          {"frames_held_out", report.frames_held_out},
          {"judged_on_held_out", fit.judged_on_held_out},
          {"before", FiguresJson(fit.before)},
          {"after", FiguresJson(fit.after)}};
}

// Calls visit(info, value) for each of the page's options.
template <typename Visitor>
void VisitPageOptions(workflow::FitOptions& options, Visitor&& visit) {
  for (const std::string_view name : kPageOptions) {
    workflow::FitOptions::Visit(options, [&]<typename T>(const OptionInfo& info, T& value) {
      if constexpr (std::is_same_v<T, int> || std::is_same_v<T, std::vector<std::string>>) {
        if (info.name == name) visit(info, value);
      }
    });
  }
}

}  // namespace

Json PageOptionsJson() {
  workflow::FitOptions defaults;
  Json json = Json::array();
  VisitPageOptions(defaults, [&](const OptionInfo& info, const auto& value) {
    Json item = {{"name", info.name}, {"help", info.help}, {"default", value}};
    if (std::isfinite(info.min)) item["min"] = info.min;
    if (std::isfinite(info.max)) item["max"] = info.max;
    json.push_back(std::move(item));
  });
  return json;
}

workflow::FitOptions ReadPageOptions(const data_io::JsonReader& json) {
  workflow::FitOptions options;
  VisitPageOptions(options, [&]<typename T>(const OptionInfo& info, T& value) {
    const auto found = json.Find(info.name);
    if (!found) return;
    if constexpr (std::is_same_v<T, int>) {
      value = static_cast<int>(
          found->Integer(static_cast<std::int64_t>(info.min), static_cast<std::int64_t>(info.max)));
    } else {
      for (const data_io::JsonReader& item : found->Items()) value.push_back(item.String());
    }
  });
  return options;
}

ViewFit::~ViewFit() {
  Stop();
  if (thread_.joinable()) thread_.join();
}

void ViewFit::Start(ViewFitRequest request) {
  const std::scoped_lock lock(mutex_);
  if (phase_ == Phase::kRunning) throw DataError("a fit is running already: stop it, or wait for its end");
  if (thread_.joinable()) thread_.join();  // it has ended and holds no lock any more
  stop_ = false;
  began_ = std::chrono::steady_clock::now();
  traced_ = 0;
  frames_ = request.real->frame_count();
  lines_.clear();
  error_.clear();
  result_.clear();
  thread_ = std::thread([this, request = std::move(request)]() mutable { Run(std::move(request)); });
  phase_ = Phase::kRunning;  // after the thread exists that ends this phase; that thread waits for the lock
}

void ViewFit::Say(const std::string& line) {
  if (stop_) throw calib::FitStopped();
  const std::scoped_lock lock(mutex_);
  lines_.push_back(line);
  if (lines_.size() > kLinesKept) lines_.pop_front();
}

void ViewFit::End(Phase phase, const std::string& error) {
  const std::scoped_lock lock(mutex_);
  phase_ = phase;
  error_ = error;
  took_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

void ViewFit::Run(ViewFitRequest request) {
  workflow::FitRecordingOptions& options = request.options;
  options.keep_images = false;
  options.fit.stop = [this] { return stop_.load(); };
  options.fit.progress = [this](const std::string& line) { Say(line); };
  options.on_note = [this](const std::string& sentence) { Say(sentence); };
  options.on_trace = [this](int frames_done, int) {
    if (stop_) throw calib::FitStopped();
    const std::scoped_lock lock(mutex_);
    traced_ = frames_done;
  };
  try {
    for (const std::string& sentence : request.messages) Say(sentence);
    const workflow::RecordingFit fit =
        workflow::FitRecording(*request.real, request.scene, request.initial, options);
    if (!fit.fit.usable) {
      return End(Phase::kFailed,
                 fmt::format("the fit ended without a usable solution ({})",
                             fit.fit.report.termination.empty() ? "the frames determine no parameter"
                                                                : fit.fit.report.termination));
    }
    {
      const std::scoped_lock lock(mutex_);
      result_ = data_io::JsonLine(ResultJson(fit));
    }
    End(Phase::kDone, {});
  } catch (const calib::FitStopped&) {
    End(Phase::kStopped, {});
  } catch (const std::bad_alloc&) {
    End(Phase::kFailed, "not enough memory for this fit");
  } catch (const std::exception& error) {
    End(Phase::kFailed, error.what());
  }
}

Json ViewFit::Status() const {
  const std::scoped_lock lock(mutex_);
  const char* word = "none";
  switch (phase_) {
    case Phase::kNone:
      break;
    case Phase::kRunning:
      word = stop_ ? "stopping" : "running";
      break;
    case Phase::kDone:
      word = "done";
      break;
    case Phase::kStopped:
      word = "stopped";
      break;
    case Phase::kFailed:
      word = "failed";
      break;
  }
  const bool running = phase_ == Phase::kRunning;
  const double elapsed_s =
      running ? std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count() : took_s_;
  Json json = {{"state", word},
               {"elapsed_s", elapsed_s},
               {"frames_traced", traced_},
               {"frames", frames_},
               {"lines", lines_}};
  if (!error_.empty()) json["error"] = error_;
  if (!result_.empty()) json["result"] = Json::parse(result_);
  return json;
}

}  // namespace sonarcal::view
