#include "apps/view/view_controls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/view/view_state.h"
#include "calib/parameters/parameter_catalog.h"
#include "core/types/parameter_table.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::ordered_json;

// A slider covers this many steps of its parameter to either side of the value at the start.
constexpr double kStepsToEitherSide = 3.0;
constexpr double kMirrorLossDb = 6.0;  // loss of a mirror that is switched on

// The model whose fits and images a control belongs to; nothing: both models of the view.
std::optional<EchoModel> ModelOf(const ModelUse& use) {
  if (use.paper && use.acoustic) return std::nullopt;
  return use.paper ? EchoModel::kPaper : EchoModel::kAcoustic;
}

// Limits of the file. Limits of a fit and ranges of the table replace them.
ControlRange RangeOfFile(const ParameterInfo& info) {
  return {.lower = info.min, .upper = info.max, .step = info.step};
}

// Sets the ends of the slider, and widens the bounds if they do not hold the value at the start.
void Settle(double start, const ControlRange& range, ViewControl& control) {
  control.lower = range.lower;
  control.upper = range.upper;
  if (!(start == 0.0 && !control.zero.empty())) {
    control.lower = std::min(control.lower, start);
    control.upper = std::max(control.upper, start);
  }
  const double middle = std::clamp(start, control.lower, control.upper);
  const double reach = kStepsToEitherSide * range.step;
  const bool by_factor = control.logarithmic && middle > 0.0;
  control.slider_lower = std::max(control.lower, by_factor ? middle * std::exp(-reach) : middle - reach);
  control.slider_upper = std::min(control.upper, by_factor ? middle * std::exp(reach) : middle + reach);
}

class Builder {
 public:
  explicit Builder(const ViewControlInput& input)
      : input_(input),
        paper_(calib::BuildCatalog(input.material_names)),
        acoustic_(calib::BuildAcousticCatalog(input.material_names, input.sonar, {},
                                              std::vector<char>(input.material_names.size(), 1))) {}

  std::vector<ViewControl> Build() {
    Walk(input_.parameters, {.path = {"parameters"}});
    AddSonar();
    std::ranges::stable_sort(placed_, {}, &Placed::order);
    std::vector<ViewControl> controls;
    for (Placed& placed : placed_) controls.push_back(std::move(placed.control));
    return controls;
  }

 private:
  // Position of a parameter: on the page, in the state that the page sends, and in names of fit.json.
  struct Place {
    std::vector<std::string> path = {};
    std::string name = {};      // prefix
    std::string fit_name = {};  // prefix in the catalogue; empty: as `name`
    ParameterTopic topic = ParameterTopic::kLevels;
    std::string part = {};
    std::optional<EchoModel> model = {};  // if each model has a control of its own
    std::string of = {};                  // added to the label
    std::optional<double> absent = {};    // value to start from, if the whole group may be absent
    bool present = true;
  };

  // Topics follow each other. In each, levels that may be absent come first, then words, then numbers.
  struct Placed {
    std::pair<ParameterTopic, int> order;
    ViewControl control;
  };

  template <typename Group>
  void Walk(const Group& group, const Place& place) {
    VisitParameters(group, [&]<typename Info, typename Member>(const Info& info, const Member& member) {
      if constexpr (std::is_same_v<Info, ParameterGroupInfo>) {
        Place below = place;
        below.path.emplace_back(info.key);
        below.name += fmt::format("{}.", info.fit_name.empty() ? info.key : info.fit_name);
        if (!below.fit_name.empty()) below.fit_name += fmt::format("{}.", info.key);
        below.topic = info.topic;
        Descend(member, below);
      } else if (!info.label.empty()) {
        Add(info, member, place);
      }
    });
  }

  template <typename Group>
  void Descend(const Group& group, const Place& place) {
    Walk(group, place);
  }

  void Descend(const std::optional<Water>&, const Place& place) { Walk(input_.water, place); }

  void Descend(const std::map<std::string, MaterialParameters>& materials, const Place& place) {
    const auto add = [&](const std::string& name, const std::string& like) {
      Place below = place;
      below.path.push_back(name);
      below.part = name;
      below.name = fmt::format("{}{}.", place.name, name);
      below.fit_name = fmt::format("{}{}.", place.name, like);
      const auto given = materials.find(name);
      const auto all_others = materials.find("default");
      const MaterialParameters& values = given != materials.end()        ? given->second
                                         : all_others != materials.end() ? all_others->second
                                                                         : MaterialParameters();
      for (const EchoModel model : {EchoModel::kPaper, EchoModel::kAcoustic}) {
        below.model = model;
        Walk(values, below);
      }
    };
    const std::vector<std::string>& names = input_.material_names;
    for (const std::string& name : names) add(name, name);
    const bool default_used =
        std::ranges::any_of(names, [&](const std::string& name) { return !materials.contains(name); });
    if (default_used) add("default", names.front());
  }

  void Descend(const std::map<std::string, MirrorParameters>& mirrors, const Place& place) {
    for (const std::string& name : input_.material_names) {
      Place below = place;
      below.path.push_back(name);
      below.name = fmt::format("{}{}.", place.name, name);
      below.of = fmt::format(" at '{}'", name);
      below.absent = kMirrorLossDb;
      const auto given = mirrors.find(name);
      Walk(given == mirrors.end() ? MirrorParameters{.loss_db = kMirrorLossDb} : given->second, below);
    }
  }

  static ViewControl Named(const ParameterInfo& info, const Place& place) {
    ViewControl control{.name = place.name + std::string(info.key),
                        .path = place.path,
                        .group = std::string(ToString(place.topic)),
                        .part = place.part,
                        .label = std::string(info.label) + place.of,
                        .unit = std::string(info.unit),
                        .model = place.model ? place.model : ModelOf(info.models),
                        .logarithmic = info.scale == ParameterScale::kLogarithmic,
                        .zero = std::string(info.zero),
                        .absent = place.absent};
    control.path.emplace_back(info.key);
    return control;
  }

  const calib::CatalogEntry* Find(EchoModel model, const std::string& name) const {
    const auto& catalog = model == EchoModel::kPaper ? paper_ : acoustic_;
    const auto found = std::ranges::find(catalog, name, &calib::CatalogEntry::name);
    return found == catalog.end() ? nullptr : &*found;
  }

  void AddNumber(const ParameterInfo& info, double start, const Place& place, ViewControl control) {
    const std::string name = place.fit_name.empty() ? control.name : place.fit_name + std::string(info.key);
    const calib::CatalogEntry* entry = Find(control.model.value_or(EchoModel::kPaper), name);
    ControlRange range = RangeOfFile(info);
    if (info.control) {
      range = *info.control;
    } else if (entry != nullptr) {
      range = {.lower = entry->lower, .upper = entry->upper, .step = entry->typical_step};
      control.fitted = place.part != "default";
    }
    Settle(start, range, control);
    const int order = control.absent ? 0 : 2;
    placed_.push_back({{place.topic, order}, std::move(control)});
  }

  void Add(const ParameterInfo& info, double start, const Place& place) {
    AddNumber(info, start, place, Named(info, place));
  }

  // A level that may be absent. It starts from black.
  void Add(const ParameterInfo& info, const std::optional<double>& start, const Place& place) {
    ViewControl control = Named(info, place);
    control.absent = input_.parameters.display.db_min;
    AddNumber(info, start.value_or(*control.absent), place, std::move(control));
  }

  template <HasWords E>
  void Add(const ParameterInfo& info, E, const Place& place) {
    ViewControl control = Named(info, place);
    control.unit = "1";
    for (const auto& [word, value] : WordsOf(std::type_identity<E>{})) control.words.emplace_back(word);
    // The page has no control for the values of a table.
    if (control.name == "beam.azimuth_pattern" && input_.parameters.beam.azimuth_table_db.empty()) {
      std::erase(control.words, ToString(AzimuthPattern::kTable));
    }
    placed_.push_back({{place.topic, 1}, std::move(control)});
  }

  void AddSonar() {
    const SonarChanges shown = SonarAsShown(input_.sonar);
    VisitParameters(shown, [&]<typename T>(const ParameterInfo& info, const std::optional<T>& start) {
      constexpr auto kTopic = ParameterTopic::kSonar;
      ViewControl control = Named(info, {.path = {"sonar"}, .name = "sonar.", .topic = kTopic});
      control.whole = std::is_same_v<T, int>;
      if (input_.recorded && IsRecorded(info.key)) control.fixed_because = "as recorded";
      ControlRange range = info.control.value_or(RangeOfFile(info));
      if (info.key == "range_min_m") range.step *= input_.sonar.axes.range_max_m;
      Settle(start.value(), range, control);
      placed_.push_back({{kTopic, 2}, std::move(control)});
    });
  }

  void Add(const ParameterInfo&, const std::vector<double>&, const Place&) {}
  void Add(const ParameterInfo&, const std::string&, const Place&) {}

  const ViewControlInput& input_;
  std::vector<calib::CatalogEntry> paper_;
  std::vector<calib::CatalogEntry> acoustic_;
  std::vector<Placed> placed_;
};

}  // namespace

std::vector<ViewControl> ViewControls(const ViewControlInput& input) {
  return Builder(input).Build();
}

Json ViewControlsJson(const std::vector<ViewControl>& controls) {
  Json json = Json::array();
  for (const ViewControl& control : controls) {
    Json item = {{"name", control.name}, {"path", control.path},   {"group", control.group},
                 {"part", control.part}, {"label", control.label}, {"unit", control.unit}};
    if (control.model) item["model"] = ToString(*control.model);
    if (!control.words.empty()) {
      item["words"] = control.words;
    } else {
      item["lower"] = control.lower;
      item["upper"] = control.upper;
      item["slider"] = {control.slider_lower, control.slider_upper};
      item["logarithmic"] = control.logarithmic;
      item["whole"] = control.whole;
      if (!control.zero.empty()) item["zero"] = control.zero;
      if (control.absent) item["absent"] = *control.absent;
    }
    item["fitted"] = control.fitted;
    if (!control.fixed_because.empty()) item["fixed_because"] = control.fixed_because;
    json.push_back(std::move(item));
  }
  return json;
}

}  // namespace sonarcal::view
