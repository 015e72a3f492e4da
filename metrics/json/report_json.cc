#include "metrics/json/report_json.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace sonarcal::metrics {
namespace {

using Json = nlohmann::ordered_json;

Json Counts(const Against& against, bool headline_only) {
  Json json;
  for (const ChangeVerdict verdict :
       {ChangeVerdict::kBetter, ChangeVerdict::kWorse, ChangeVerdict::kSame, ChangeVerdict::kNotTold}) {
    json[std::string(ToString(verdict))] = against.Count(verdict, headline_only);
  }
  return json;
}

// Rounds to six decimals: a thousandth of a grey level of 255 or less, at half the length.
Json SixDecimals(const std::optional<double>& value) {
  return value ? Json(std::round(*value * 1e6) / 1e6) : Json(nullptr);
}

// Sums of many classes as lists of one length.
class SumsLists {
 public:
  void Add(const DifferenceSums& sums) {
    pixels_.push_back(sums.pixels);
    bias_.push_back(SixDecimals(sums.bias()));
    mean_absolute_.push_back(SixDecimals(sums.mean_absolute()));
  }

  Json ToJson() const { return {{"pixels", pixels_}, {"bias", bias_}, {"mean_absolute", mean_absolute_}}; }

 private:
  Json pixels_ = Json::array();
  Json bias_ = Json::array();
  Json mean_absolute_ = Json::array();
};

Json TableJson(const ResidualTable& table) {
  Json name = Json::array();
  Json from = Json::array();
  Json to = Json::array();
  SumsLists whole;
  SumsLists in_union;
  for (const ResidualClass& line : table.classes) {
    name.push_back(line.name);
    from.push_back(Nullable(line.from));
    to.push_back(Nullable(line.to));
    whole.Add(line.sums.whole);
    in_union.Add(line.sums.union_region);
  }
  Json json;
  if (table.unit.empty()) {
    json["name"] = std::move(name);
  } else {
    json["unit"] = table.unit;
    json["from"] = std::move(from);
    json["to"] = std::move(to);
  }
  json["whole"] = whole.ToJson();
  json["union"] = in_union.ToJson();
  return json;
}

Json MapJson(const ResidualMap& map) {
  SumsLists whole;
  SumsLists in_union;
  for (const ResidualSums& sums : map.cells.values()) {
    whole.Add(sums.whole);
    in_union.Add(sums.union_region);
  }
  return {{"rows", map.cells.rows()}, {"cols", map.cells.cols()}, {"bins", map.bins},
          {"beams", map.beams},       {"whole", whole.ToJson()},  {"union", in_union.ToJson()}};
}

}  // namespace

Json Nullable(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json ResidualsJson(const ResidualCollector& residuals, const std::vector<ResidualTable>& by_scene) {
  if (residuals.frames() == 0) return nullptr;
  Json json;
  json["frames"] = residuals.frames();
  json["frames_left_out"] = residuals.frames_left_out();
  json["by_range"] = TableJson(residuals.ByRange());
  json["by_beam"] = TableJson(residuals.ByBeam());
  for (const ResidualTable& table : by_scene) json["by_" + table.by] = TableJson(table);
  json["map"] = MapJson(residuals.map());
  return json;
}

Json AgainstJson(const Against& against) {
  Json json = Counts(against, true);
  // A check by --fail-above must not pass because nothing is known.
  if (!against.unknown.empty()) json["better"] = json["worse"] = nullptr;
  json["earlier"] = against.earlier;
  json["common_frames"] = against.common_frames;
  json["method"] = against.common_frames > 0
                       ? "paired bootstrap over the common frames, 95 %"
                       : "whether the two 95 % intervals are apart; too few frames stand in both";
  json["all_figures"] = Counts(against, false);
  json["figures"] = Json::array();
  for (const FigureChange& change : against.figures) {
    Json row;
    row["view"] = change.fan ? "fan" : "polar";
    row["figure"] = change.path;
    row["headline"] = change.headline;
    row["earlier"] = change.earlier;
    row["now"] = change.now;
    row["worsening"] = change.worsening;
    row["worsening_ci"] =
        change.worsening_ci ? Json::array({change.worsening_ci->lo, change.worsening_ci->hi}) : Json(nullptr);
    row["verdict"] = std::string(ToString(change.verdict));
    row["explained"] = change.explained ? Json(*change.explained) : Json(nullptr);
    json["figures"].push_back(std::move(row));
  }
  json["notes"] = against.notes;
  return json;
}

}  // namespace sonarcal::metrics
