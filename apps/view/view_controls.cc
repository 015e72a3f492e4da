#include "apps/view/view_controls.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/view/view_state.h"
#include "calib/parameters/parameter_catalog.h"
#include "data_io/json/json_fields.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::ordered_json;

// A slider extends this many surprisingly large steps (calib/parameters/parameter_catalog.h) to either side
// of its start.
constexpr double kStepsToEitherSide = 3.0;
constexpr double kLevelStepDb = 20.0;
constexpr double kMirrorLossDb = 6.0;  // loss of a mirror when it is switched on

constexpr std::array<std::pair<const char*, const char*>, 6> kGsabLabels = {
    {{"A", "A, specular amplitude"},
     {"B_deg", "B, specular half-width"},
     {"C", "C, oblique level"},
     {"D", "D, exponent of the cosine"},
     {"E", "E, transitional amplitude"},
     {"F_deg", "F, transitional half-width"}}};

// A number that no fit changes, or one of the catalog under its name there.
struct Number {
  const char* name;  // path below "parameters", with dots
  const char* group;
  const char* label;
  std::optional<EchoModel> model = {};
  const char* unit = nullptr;  // nullptr: unit, bounds and step are those of the catalog
  double lower = 0.0;
  double upper = 0.0;
  double step = 1.0;
  bool logarithmic = false;
  const char* zero = "";
};

constexpr const char* kLevels = "Levels and display";
constexpr const char* kErrors = "Range and azimuth errors";
constexpr const char* kReceiver = "Receiver and noise";
constexpr const char* kBeamAndPulse = "Beam and pulse";
constexpr const char* kWater = "Water";
constexpr const char* kSonar = "Sonar";
constexpr const char* kMaterials = "Materials";
constexpr const char* kMirrors = "Mirrors (ghosts)";

constexpr std::optional<EchoModel> kBoth = std::nullopt;
constexpr EchoModel kPaper = EchoModel::kPaper;
constexpr EchoModel kAcoustic = EchoModel::kAcoustic;

// Bounds are the widest that data_io/parameters/parameters_io.h reads, unless a formula requires narrower
// ones.
constexpr std::array kNumbers = {
    Number{"source_level_db", kLevels, "Source level", kBoth},
    Number{"noise_level_db", kLevels, "Noise level NL (Eq. 10)", kPaper, "dB", -500, 500, kLevelStepDb},
    Number{"array_gain_db", kLevels, "Array gain AG (Eq. 10)", kPaper, "dB", -500, 500, kLevelStepDb},
    Number{"display.db_min", kLevels, "Level shown as black", kBoth},
    Number{"display.db_max", kLevels, "Level shown as full scale", kBoth},
    Number{"display.soft_db", kLevels, "Level that softens the logarithm", kAcoustic, "dB", -500, 500,
           kLevelStepDb},
    Number{"display.exponent", kLevels, "Exponent of the law 'power'", kAcoustic, "1", 0.01, 10, 1.0, true},
    Number{"jitter.sigma_range_m", kErrors, "Range error, at short range", kPaper, nullptr, 0, 0, 1, true,
           "none"},
    Number{"jitter.sigma_azimuth_deg", kErrors, "Azimuth error, at short range", kPaper, nullptr, 0, 0, 1,
           true, "none"},
    Number{"jitter.reference_range_m", kErrors, "Range from which they grow", kPaper},
    Number{"jitter.reference_frequency_hz", kErrors, "Frequency they are given for", kPaper, "Hz", 1e3, 1e8,
           1.0, true},
    Number{"receiver.gain_db", kReceiver, "Gain", kAcoustic},
    Number{"receiver.noise_slope_db_per_m", kReceiver, "Trend of the noise with range", kAcoustic},
    Number{"receiver.looks", kReceiver, "Looks averaged in a pixel", kAcoustic, "1", 1, 1000, 1.0, true},
    Number{"beam.azimuth_width_deg", kBeamAndPulse, "Beam width, azimuth", kAcoustic, nullptr, 0, 0, 1, true,
           "the sonar's own"},
    Number{"beam.elevation_width_deg", kBeamAndPulse, "Beam width, elevation", kAcoustic, nullptr, 0, 0, 1,
           true, "the sonar's own"},
    Number{"beam.azimuth_taper", kBeamAndPulse, "Azimuth taper: 0 uniform, 1 Hann", kAcoustic, "1", 0, 1,
           1.0},
    Number{"beam.elevation_taper", kBeamAndPulse, "Elevation taper: 0 uniform, 1 Hann", kAcoustic, "1", 0, 1,
           1.0},
    Number{"beam.transmit_even_deg", kBeamAndPulse, "Sent evenly up to, for ghosts", kAcoustic, "deg", 0, 90,
           30.0},
    Number{"beam.transmit_end_deg", kBeamAndPulse, "Sent up to, for ghosts", kAcoustic, "deg", 0, 90, 30.0},
    Number{"pulse.length_m", kBeamAndPulse, "Pulse length", kAcoustic, nullptr, 0, 0, 1, true,
           "one range bin"},
    Number{"water.temperature_c", kWater, "Temperature", kBoth, "C", -4, 100, 10.0},
    Number{"water.salinity_ppt", kWater, "Salinity", kBoth, "ppt", 0, 350, 14.0},
    Number{"water.ph", kWater, "pH", kBoth, "1", 0, 14, 0.5},
    Number{"water.depth_m", kWater, "Depth", kBoth, "m", 0, 12000, 100.0},
};

struct Choice {
  const char* name;
  const char* group;
  const char* label;
  EchoModel model;
  std::array<const char*, 4> words;  // as in params.json
};

constexpr std::array kChoices = {
    Choice{"display.law", kLevels, "Display law", kAcoustic, {"log", "soft_log", "soft_amplitude", "power"}},
    Choice{"jitter.growth", kErrors, "Growth with range", kPaper, {"root", "linear", nullptr, nullptr}},
    Choice{"receiver.time_varied_gain",
           kReceiver,
           "Time-varied gain",
           kAcoustic,
           {"none", "20logR", "40logR", "40logR+alpha"}},
    Choice{"beam.azimuth_pattern",
           kBeamAndPulse,
           "Pattern in azimuth",
           kAcoustic,
           {"gaussian", "aperture", nullptr, nullptr}},
    Choice{"beam.elevation_pattern",
           kBeamAndPulse,
           "Pattern in elevation",
           kAcoustic,
           {"gaussian", "aperture", "cosine", nullptr}},
    Choice{"beam.mirror_lobes",
           kBeamAndPulse,
           "Mirrors seen through lobes",
           kAcoustic,
           {"all", "main", nullptr, nullptr}},
};

std::vector<std::string> PathOf(const std::string& root, std::string_view name) {
  std::vector<std::string> path = {root};
  while (!name.empty()) {
    const std::size_t dot = std::min(name.find('.'), name.size());
    path.emplace_back(name.substr(0, dot));
    name.remove_prefix(std::min(dot + 1, name.size()));
  }
  return path;
}

class Builder {
 public:
  explicit Builder(const ViewControlInput& input)
      : input_(input),
        start_({{"parameters", data_io::ParametersJson(input.parameters)}}),
        paper_(calib::BuildCatalog(input.material_names)),
        acoustic_(calib::BuildAcousticCatalog(input.material_names, input.sonar, {},
                                              std::vector<char>(input.material_names.size(), 1))) {
    start_["parameters"]["water"] = data_io::WaterJson(input.water);
  }

  std::vector<ViewControl> Build() {
    AddGroup(kLevels);
    for (const std::string& material : input_.material_names) AddMaterial(material, material);
    if (IsDefaultUsed()) AddMaterial("default", input_.material_names.front());
    AddGroup(kErrors);
    AddNoiseLevels();
    AddGroup(kReceiver);
    AddGroup(kBeamAndPulse);
    for (const std::string& material : input_.material_names) AddMirror(material);
    AddGroup(kWater);
    AddSonar();
    return std::move(controls_);
  }

 private:
  bool IsDefaultUsed() const {
    const auto& materials = input_.parameters.materials;
    return std::any_of(input_.material_names.begin(), input_.material_names.end(),
                       [&](const std::string& name) { return materials.find(name) == materials.end(); });
  }

  std::optional<double> StartOf(const std::vector<std::string>& path) const {
    const Json* node = &start_;
    for (const std::string& key : path) {
      const auto found = node->find(key);
      if (found == node->end()) return std::nullopt;
      node = &*found;
    }
    if (!node->is_number()) return std::nullopt;
    return node->get<double>();
  }

  // Sets the ends of the slider, and widens the bounds to contain the start value of any file.
  static void Settle(double start, double step, ViewControl& control) {
    if (!(start == 0.0 && !control.zero.empty())) {
      control.lower = std::min(control.lower, start);
      control.upper = std::max(control.upper, start);
    }
    const double middle = std::clamp(start, control.lower, control.upper);
    const double reach = kStepsToEitherSide * step;
    const bool by_factor = control.logarithmic && middle > 0.0;
    control.slider_lower = std::max(control.lower, by_factor ? middle * std::exp(-reach) : middle - reach);
    control.slider_upper = std::min(control.upper, by_factor ? middle * std::exp(reach) : middle + reach);
  }

  const calib::CatalogEntry* Find(EchoModel model, const std::string& name) const {
    const auto& catalog = model == kPaper ? paper_ : acoustic_;
    const auto found = std::find_if(catalog.begin(), catalog.end(),
                                    [&](const calib::CatalogEntry& entry) { return entry.name == name; });
    return found == catalog.end() ? nullptr : &*found;
  }

  void AddOfCatalog(const calib::CatalogEntry& entry, double start, ViewControl control) {
    control.unit = entry.unit;
    control.lower = entry.lower;
    control.upper = entry.upper;
    control.logarithmic = entry.logarithmic;
    Settle(start, entry.typical_step, control);
    controls_.push_back(std::move(control));
  }

  void Add(const Number& number) {
    ViewControl control{.name = number.name,
                        .path = PathOf("parameters", number.name),
                        .group = number.group,
                        .label = number.label,
                        .model = number.model,
                        .zero = number.zero};
    const double start = StartOf(control.path).value_or(0.0);
    if (number.unit == nullptr) {
      const calib::CatalogEntry* entry = Find(number.model.value_or(kPaper), number.name);
      control.fitted = true;
      return AddOfCatalog(*entry, start, std::move(control));
    }
    control.unit = number.unit;
    control.lower = number.lower;
    control.upper = number.upper;
    control.logarithmic = number.logarithmic;
    Settle(start, number.step, control);
    controls_.push_back(std::move(control));
  }

  void AddGroup(const char* group) {
    for (const Choice& choice : kChoices) {
      if (choice.group != group) continue;
      ViewControl control{.name = choice.name,
                          .path = PathOf("parameters", choice.name),
                          .group = group,
                          .label = choice.label,
                          .unit = "1",
                          .model = choice.model};
      for (const char* word : choice.words) {
        if (word != nullptr) control.words.emplace_back(word);
      }
      const bool has_table = !input_.parameters.beam.azimuth_table_db.empty();
      if (has_table && control.name == "beam.azimuth_pattern") control.words.emplace_back("table");
      controls_.push_back(std::move(control));
    }
    for (const Number& number : kNumbers) {
      if (number.group == group) Add(number);
    }
  }

  // `like`: material of the scene whose bounds in the catalog apply.
  void AddMaterial(const std::string& material, const std::string& like) {
    for (const EchoModel model : {kPaper, kAcoustic}) {
      for (const auto& [key, label] : kGsabLabels) {
        ViewControl control{.name = fmt::format("material.{}.gsab.{}", material, key),
                            .path = {"parameters", "materials", material, "gsab", key},
                            .group = kMaterials,
                            .part = material,
                            .label = label,
                            .model = model,
                            .zero = key[0] == 'A' || key[0] == 'C' || key[0] == 'E' ? "none" : "",
                            .fitted = material != "default"};
        std::optional<double> start = StartOf(control.path);
        if (!start) start = StartOf({"parameters", "materials", "default", "gsab", key});
        AddOfCatalog(*Find(model, fmt::format("material.{}.gsab.{}", like, key)), start.value_or(1.0),
                     std::move(control));
      }
    }
  }

  // Adds noise levels that may be absent.
  void AddNoiseLevels() {
    const double black_db = input_.parameters.display.db_min;
    for (const auto& [name, label] : {std::pair{"receiver.noise_db", "Noise level before gain over range"},
                                      {"receiver.noise_after_gain_db", "Noise level behind it"}}) {
      ViewControl control{.name = name,
                          .path = PathOf("parameters", name),
                          .group = kReceiver,
                          .label = label,
                          .unit = "dB",
                          .model = kAcoustic,
                          .lower = -500.0,
                          .upper = 500.0,
                          .absent = black_db,
                          .fitted = Find(kAcoustic, name) != nullptr};
      Settle(StartOf(control.path).value_or(black_db), kLevelStepDb, control);
      controls_.push_back(std::move(control));
    }
  }

  void AddMirror(const std::string& material) {
    const std::string name = fmt::format("mirror.{}.loss_db", material);
    ViewControl control{.name = name,
                        .path = {"parameters", "mirror", material, "loss_db"},
                        .group = kMirrors,
                        .label = fmt::format("Loss at '{}'", material),
                        .model = kAcoustic,
                        .absent = kMirrorLossDb,
                        .fitted = true};
    const double start_db = StartOf(control.path).value_or(kMirrorLossDb);
    AddOfCatalog(*Find(kAcoustic, name), start_db, std::move(control));
  }

  void AddSonar() {
    const SonarModel& sonar = input_.sonar;
    const PolarAxes& axes = sonar.axes;
    const auto add = [&](const char* key, const char* label, const char* unit, double start, double lower,
                         double upper, double step, bool logarithmic, bool whole, bool of_window,
                         std::optional<EchoModel> model = {}) {
      ViewControl control{.name = fmt::format("sonar.{}", key),
                          .path = {"sonar", key},
                          .group = kSonar,
                          .label = label,
                          .unit = unit,
                          .model = model,
                          .lower = lower,
                          .upper = upper,
                          .logarithmic = logarithmic,
                          .whole = whole};
      if (of_window && input_.recorded) control.fixed_because = "as recorded";
      Settle(start, step, control);
      controls_.push_back(std::move(control));
    };
    add("frequency_hz", "Frequency", "Hz", sonar.frequency_hz, 1e3, 1e8, 0.5, true, false, false);
    add("range_min_m", "Nearest range", "m", axes.range_min_m, 0.0, 1000.0, 0.3 * axes.range_max_m, false,
        false, true);
    add("range_max_m", "Farthest range", "m", axes.range_max_m, 0.01, 1000.0, 0.4, true, false, true);
    add("range_bins", "Range bins", "1", axes.range_bins, 2, kMaxRangeBins, 0.4, true, true, true);
    add("beams", "Beams", "1", axes.beam_count(), 2, kMaxBeams, 0.4, true, true, true);
    add("field_of_view_deg", "Field of view, azimuth", "deg", FieldOfViewDeg(axes), 1.0, 170.0, 0.4, true,
        false, true);
    add("elevation_beam_width_deg", "Field of view, elevation", "deg", sonar.elevation_beam_width_deg, 0.1,
        170.0, 0.4, true, false, false);
    add("azimuth_beam_width_deg", "Width of a beam", "deg", sonar.azimuth_beam_width_deg, 0.01, 170.0, 0.6,
        true, false, false, kAcoustic);
  }

  const ViewControlInput& input_;
  Json start_;
  std::vector<calib::CatalogEntry> paper_;
  std::vector<calib::CatalogEntry> acoustic_;
  std::vector<ViewControl> controls_;
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
