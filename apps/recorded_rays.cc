#include "apps/recorded_rays.h"

#include <fmt/format.h>

#include <optional>

namespace sonarcal {
namespace {

// The value of a detail, as SimulatedRecordingInfo (apps/simulate_recording.h) writes it; empty: none.
std::string Detail(const RecordingInfo& info, const std::string& name) {
  for (const auto& [key, value] : info.details) {
    if (key == name) return value;
  }
  return {};
}

struct StatedRays {
  Sampling sampling = Sampling::kFrustum;
  RayWeight weight = RayWeight::kEven;
  std::string grid;  // "1500x1200"
};

// From "1500x1200, frustum" and "even".
std::optional<StatedRays> Stated(const RecordingInfo& info) {
  if (!info.synthetic || Detail(info, "model") != "paper") return std::nullopt;
  const std::string text = Detail(info, "rays");
  const std::size_t comma = text.find(", ");
  if (comma == std::string::npos) return std::nullopt;
  const std::string word = text.substr(comma + 2, text.find(',', comma + 1) - comma - 2);
  StatedRays stated{.grid = text.substr(0, comma)};
  bool known = false;
  for (const Sampling sampling : {Sampling::kFrustum, Sampling::kBeams}) {
    if (word != ToString(sampling)) continue;
    stated.sampling = sampling;
    known = true;
  }
  if (Detail(info, "ray weight") == ToString(RayWeight::kSolidAngle)) stated.weight = RayWeight::kSolidAngle;
  return known ? std::optional(stated) : std::nullopt;
}

}  // namespace

RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model) {
  RaysForFit choice{.rays = asked, .note = {}, .warning = {}};
  if (model != EchoModel::kPaper) return choice;
  const auto stated = Stated(info);
  if (!stated) {
    choice.rays.sampling = asked.SamplingFor(model);
    return choice;
  }
  if (!asked.sampling) {
    choice.rays.sampling = stated->sampling;
    choice.rays.weight = stated->weight;
    if (asked.rays.empty()) choice.rays.rays = stated->grid;
    choice.note = fmt::format("rays as the recording states its own: {}, {}, weight {}", choice.rays.rays,
                              ToString(stated->sampling), ToString(stated->weight));
    return choice;
  }
  if (*asked.sampling != stated->sampling || asked.weight != stated->weight) {
    choice.warning = fmt::format(
        "the recording was simulated with {} rays of weight {}, but the fit casts {} rays of weight {}: "
        "their "
        "images differ, and fitted values are biased by more than their standard errors (without --sampling, "
        "the fit takes the recording's)",
        ToString(stated->sampling), ToString(stated->weight), ToString(*asked.sampling),
        ToString(asked.weight));
  }
  return choice;
}

}  // namespace sonarcal
