#include "apps/report/detection/false_alarm_section.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

std::string StatedText(const metrics::FalseAlarmRate& rate) {
  return rate.stated ? fmt::format("{:g}", *rate.stated) : "none";
}

std::string RealisedText(const metrics::FalseAlarmRate& rate) {
  return fmt::format("{:.3g}", rate.realised());
}

std::string IntervalText(const metrics::FalseAlarmRate& rate) {
  return rate.ci ? fmt::format("{:.3g} to {:.3g}", rate.ci->lo, rate.ci->hi) : "none";
}

}  // namespace

void AddFalseAlarms(HtmlReport& report, const std::vector<metrics::FalseAlarmRate>& rates) {
  if (rates.empty()) return;
  report.Section("False alarms");
  Table table{.caption = fmt::format("Share of the {} pixels that a segmentation takes for object",
                                     rates.front().pixels),
              .columns = {{"Method"}, {"Stated"}, {"Realised"}, {"95 %"}},
              .rows = {},
              .notes = {"Settings are the defaults of compare, with the looks of the law. Regions are not "
                        "tidied. A method without a stated rate states none.",
                        "Intervals: bootstrap over pings, in blocks of consecutive ones."}};
  for (const metrics::FalseAlarmRate& rate : rates) {
    table.rows.push_back(
        {{std::string(ToString(rate.method)), StatedText(rate), RealisedText(rate), IntervalText(rate)}});
  }
  report.Add(table);
}

std::string FalseAlarmsText(const std::vector<metrics::FalseAlarmRate>& rates) {
  if (rates.empty()) return {};
  std::string text = fmt::format("  false alarms, share of {} pixels:\n    {:<18}{:>8}{:>11}   95 %\n",
                                 rates.front().pixels, "method", "stated", "realised");
  for (const metrics::FalseAlarmRate& rate : rates) {
    text += fmt::format("    {:<18}{:>8}{:>11}   {}\n", ToString(rate.method), StatedText(rate),
                        RealisedText(rate), IntervalText(rate));
  }
  return text;
}

Json FalseAlarmsJson(const std::vector<metrics::FalseAlarmRate>& rates) {
  Json list = Json::array();
  for (const metrics::FalseAlarmRate& rate : rates) {
    list.push_back({{"method", ToString(rate.method)},
                    {"stated", rate.stated ? Json(*rate.stated) : Json(nullptr)},
                    {"realised", rate.realised()},
                    {"ci", rate.ci ? Json::array({rate.ci->lo, rate.ci->hi}) : Json(nullptr)},
                    {"alarms", rate.alarms},
                    {"pixels", rate.pixels}});
  }
  return list;
}

}  // namespace sonarcal::report
