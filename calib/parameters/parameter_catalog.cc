#include "calib/parameters/parameter_catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <type_traits>

#include "calib/parameters/pose_step.h"
#include "core/types/parameter_table.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Limits and step in the parameter's own unit.
struct FitRange {
  FitLimits limits;
  double step = 1.0;
};

FitRange InOwnUnit(const FitLimits& limits, double step, const SonarModel& sonar) {
  const auto times = [&](double factor) { return FitLimits{limits.lower * factor, limits.upper * factor}; };
  switch (limits.unit) {
    case LimitUnit::kValue:
      return {limits, step};
    case LimitUnit::kBeamSpacings:
      return {times(DegFromRad(sonar.axes.beam_spacing_rad())), step};
    case LimitUnit::kRangeBins:
      return {times(sonar.axes.range_bin_m()), step};
    case LimitUnit::kPerWindow: {
      const double window_m = sonar.axes.range_max_m - sonar.axes.range_min_m;
      return {{limits.lower / window_m, limits.upper / window_m}, step / window_m};
    }
    case LimitUnit::kBeyondBeams:
      break;
  }
  const double edge_deg = DegFromRad(sonar.axes.OuterEdgeRad());
  return {{edge_deg + limits.lower, edge_deg + limits.upper}, step};
}

// Factor about a width that the sonar states. A wrong outline or pose would otherwise become a wrong beam.
constexpr double kStatedFactor = 2.0;

// Width that the sonar states, in the unit of the parameter; 0: none.
double StatedWidth(std::string_view name, const SonarModel& sonar) {
  if (name == "beam.azimuth_width_deg") return sonar.azimuth_beam_width_deg;
  if (name == "beam.elevation_width_deg") return sonar.elevation_beam_width_deg;
  return 0.0;
}

// Builds the entries of one image model from the table of parameters, in the order of ParameterGroup.
class CatalogBuilder {
 public:
  CatalogBuilder(EchoModel model, const SonarModel& sonar, const std::vector<std::string>& materials,
                 const std::vector<char>& mirrors)
      : model_(model), sonar_(sonar), materials_(materials), mirrors_(mirrors) {}

  std::vector<CatalogEntry> Build() {
    Walk(ParameterSet(), {.name = "", .group = ParameterGroup::kSourceLevel});
    std::ranges::stable_sort(catalog_, {}, &CatalogEntry::group);
    return std::move(catalog_);
  }

 private:
  struct Place {
    std::string name;  // prefix of the entries' names
    ParameterGroup group = ParameterGroup::kSourceLevel;
    int material = -1;
    int mirror = -1;
  };

  static ParameterGroup GroupOf(std::string_view key) {
    static const std::map<std::string_view, ParameterGroup> kGroups = {
        {"display", ParameterGroup::kDisplay},   {"gsab", ParameterGroup::kGsab},
        {"mirror", ParameterGroup::kMirror},     {"jitter", ParameterGroup::kJitter},
        {"receiver", ParameterGroup::kReceiver}, {"beam", ParameterGroup::kBeam},
        {"pulse", ParameterGroup::kPulse}};
    const auto found = kGroups.find(key);
    return found == kGroups.end() ? ParameterGroup::kSourceLevel : found->second;
  }

  template <typename Group>
  void Walk(const Group& group, const Place& place) {
    int index = 0;
    VisitParameters(group, [&]<typename Info, typename Member>(const Info& info, const Member& member) {
      if constexpr (std::is_same_v<Info, ParameterInfo>) {
        index += Add(info, place, index) ? 1 : 0;
      } else {
        const std::string_view name = info.fit_name.empty() ? info.key : info.fit_name;
        Descend(member, {.name = fmt::format("{}{}.", place.name, name),
                         .group = GroupOf(info.key),
                         .material = place.material});
      }
    });
  }

  template <typename Group>
  void Descend(const Group& group, const Place& place) {
    Walk(group, place);
  }

  void Descend(const std::optional<Water>&, const Place&) {}  // known, not fitted

  void Descend(const std::map<std::string, MaterialParameters>&, const Place& place) {
    for (std::size_t i = 0; i < materials_.size(); ++i) {
      Walk(MaterialParameters(),
           {.name = fmt::format("{}{}.", place.name, materials_[i]), .material = static_cast<int>(i)});
    }
  }

  void Descend(const std::map<std::string, MirrorParameters>&, const Place& place) {
    for (std::size_t i = 0; i < mirrors_.size(); ++i) {
      if (mirrors_[i] == 0) continue;
      Walk(MirrorParameters(), {.name = fmt::format("{}{}.", place.name, materials_[i]),
                                .group = place.group,
                                .mirror = static_cast<int>(i)});
    }
  }

  // Returns whether a fit of the model may change the parameter.
  bool Add(const ParameterInfo& info, const Place& place, int index) {
    const std::optional<FitLimits>& fit = model_ == EchoModel::kPaper ? info.paper_fit : info.acoustic_fit;
    if (!fit) return false;
    const bool transmit = fit->unit == LimitUnit::kBeyondBeams;
    if (transmit && std::ranges::count(mirrors_, 1) == 0) return false;
    auto [limits, step] = InOwnUnit(*fit, info.step, sonar_);
    if (const double width = StatedWidth(place.name + std::string(info.key), sonar_); width > 0.0)
      limits = {width / kStatedFactor, width * kStatedFactor};
    // The reader of params.json must not refuse what a fit finds.
    limits.lower = std::max(limits.lower, info.min);
    limits.upper = std::min(limits.upper, info.max);
    if (!(limits.lower < limits.upper)) return false;  // transmission ends beyond beams of 89 degrees
    catalog_.push_back({.name = place.name + std::string(info.key),
                        .key = info.key,
                        .unit = std::string(info.unit),
                        .group = transmit ? ParameterGroup::kTransmit : place.group,
                        .material = place.material,
                        .mirror = place.mirror,
                        .index = index,
                        .lower = limits.lower,
                        .upper = limits.upper,
                        .file_lower = info.min,
                        .file_upper = info.max,
                        .logarithmic = info.scale == ParameterScale::kLogarithmic,
                        .typical_step = step});
    return true;
  }

  EchoModel model_;
  const SonarModel& sonar_;
  const std::vector<std::string>& materials_;
  const std::vector<char>& mirrors_;
  std::vector<CatalogEntry> catalog_;
};

void AddPose(const std::string& name, int frame, std::vector<CatalogEntry>& catalog) {
  for (int index = 0; index < kPoseSteps; ++index) {
    const bool angle = index >= 3;
    catalog.push_back({.name = fmt::format("pose.{}.{}", name, kPoseNames[index]),
                       .unit = angle ? "deg" : "m",
                       .group = ParameterGroup::kPose,
                       .index = index,
                       .frame = frame,
                       .lower = angle ? -720.0 : -1e5,
                       .upper = angle ? 720.0 : 1e5,
                       .typical_step = angle ? 3.0 : 0.1});
  }
}

void AddPoses(const std::vector<int>& frames, std::vector<CatalogEntry>& catalog) {
  AddPose("mount", kMountFrame, catalog);
  for (std::size_t frame = 0; frame < frames.size(); ++frame) {
    AddPose(fmt::format("{}", frames[frame]), static_cast<int>(frame), catalog);
  }
}

// Priors from what data sheets and tape measures leave open: `step` is their standard deviation. The tilt and
// the offset of the azimuth are as well known as a mount is built.
struct GeometryEntry {
  const char* name;
  const char* unit;
  double SonarGeometry::*member;
  double lower;
  double upper;
  double step;
};
constexpr std::array kGeometryEntries = {
    GeometryEntry{"range_offset_m", "m", &SonarGeometry::range_offset_m, -1.0, 1.0, 0.05},
    GeometryEntry{"range_scale", "1", &SonarGeometry::range_scale, 0.8, 1.25, 0.02},
    GeometryEntry{"azimuth_offset_deg", "deg", &SonarGeometry::azimuth_offset_deg, -20.0, 20.0, 1.0},
    GeometryEntry{"azimuth_scale", "1", &SonarGeometry::azimuth_scale, 0.8, 1.25, 0.02},
    GeometryEntry{"azimuth_cubic", "1", &SonarGeometry::azimuth_cubic, -0.2, 0.2, 0.01},
    GeometryEntry{"tilt_deg", "deg", &SonarGeometry::tilt_deg, -45.0, 45.0, 2.0}};

void AddGeometry(const SonarModel& sonar, std::vector<CatalogEntry>& catalog) {
  // The corrected window begins ahead of the sonar.
  constexpr double kOfWindowStart = 0.7;
  for (std::size_t i = 0; i < kGeometryEntries.size(); ++i) {
    const GeometryEntry& of = kGeometryEntries[i];
    const bool offset = of.member == &SonarGeometry::range_offset_m;
    const double lower = offset ? std::max(of.lower, -kOfWindowStart * sonar.axes.range_min_m) : of.lower;
    catalog.push_back({.name = fmt::format("geometry.{}", of.name),
                       .unit = of.unit,
                       .group = ParameterGroup::kGeometry,
                       .index = static_cast<int>(i),
                       .lower = lower,
                       .upper = of.upper,
                       .typical_step = of.step});
  }
}

void AddObject(const std::string& name, int object, std::vector<CatalogEntry>& catalog) {
  constexpr std::array kScales = {"scale_x", "scale_y", "scale_z"};
  for (int index = 0; index < kPoseSteps + 3; ++index) {
    const bool scale = index >= kPoseSteps;
    const bool angle = index >= 3 && !scale;
    catalog.push_back(
        {.name = fmt::format("object.{}.{}", name, scale ? kScales[index - kPoseSteps] : kPoseNames[index]),
         .unit = scale   ? "1"
                 : angle ? "deg"
                         : "m",
         .group = ParameterGroup::kObject,
         .index = index,
         .object = object,
         .lower = scale   ? 0.5
                  : angle ? -180.0
                          : -100.0,
         .upper = scale   ? 2.0
                  : angle ? 180.0
                          : 100.0,
         .typical_step = scale   ? 0.02
                         : angle ? 3.0
                                 : 0.05});
  }
}

void AddOutline(const OutlineForm& form, int outline, std::vector<CatalogEntry>& catalog) {
  for (int index = 0; index < form.count; ++index) {
    catalog.push_back({.name = fmt::format("outline.{}.{}", form.name, form.NameOf(index)),
                       .unit = "m",
                       .group = ParameterGroup::kOutline,
                       .index = index,
                       .object = outline,
                       .lower = -form.limit_m(),
                       .upper = form.limit_m(),
                       .typical_step = form.sigma_m()});
  }
}

}  // namespace

double DeclaredValue(const CatalogEntry& entry) {
  if (entry.group == ParameterGroup::kGeometry) return SonarGeometry().*kGeometryEntries[entry.index].member;
  return entry.group == ParameterGroup::kObject && entry.index >= kPoseSteps ? 1.0 : 0.0;
}

void SetGeometry(std::string_view entry_name, double value, SonarGeometry& geometry) {
  for (const GeometryEntry& of : kGeometryEntries) {
    if (entry_name.substr(entry_name.rfind('.') + 1) == of.name) geometry.*of.member = value;
  }
}

SonarGeometry GeometryOf(const std::vector<CatalogEntry>& catalog, const ParameterValues& values) {
  SonarGeometry geometry;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (catalog[i].group == ParameterGroup::kGeometry)
      geometry.*kGeometryEntries[catalog[i].index].member = values[i];
  }
  return geometry;
}

double CostOfPriors(const std::vector<CatalogEntry>& catalog, const std::vector<int>& entries,
                    const ParameterValues& values) {
  double cost = 0.0;
  for (const int entry : entries) cost += 0.5 * std::pow(catalog[entry].FromPrior(values[entry]), 2);
  return cost;
}

std::vector<CatalogEntry> BuildCatalog(const std::vector<std::string>& material_names) {
  return CatalogBuilder(EchoModel::kPaper, SonarModel(), material_names, {}).Build();
}

void NarrowToRealCurves(CatalogEntry& gsab_entry) {
  const GsabParameters<double> curve;
  VisitParameters(curve, [&](const ParameterInfo& info, double) {
    if (info.key != gsab_entry.key) return;
    gsab_entry.lower = info.acoustic_fit->lower;
    gsab_entry.upper = info.acoustic_fit->upper;
  });
}

std::vector<CatalogEntry> BuildAcousticCatalog(const std::vector<std::string>& material_names,
                                               const SonarModel& sonar, const std::vector<int>& frames,
                                               const std::vector<char>& mirrors,
                                               const std::vector<std::string>& objects,
                                               const std::vector<OutlineForm>& outlines) {
  std::vector<CatalogEntry> catalog =
      CatalogBuilder(EchoModel::kAcoustic, sonar, material_names, mirrors).Build();
  AddPoses(frames, catalog);
  AddGeometry(sonar, catalog);
  for (std::size_t i = 0; i < objects.size(); ++i) AddObject(objects[i], static_cast<int>(i), catalog);
  for (std::size_t i = 0; i < outlines.size(); ++i) AddOutline(outlines[i], static_cast<int>(i), catalog);
  return catalog;
}

double& AcousticSlot(ParameterSet& parameters, const std::vector<std::string>& material_names,
                     const CatalogEntry& entry) {
  switch (entry.group) {
    case ParameterGroup::kReceiver:
      return ParameterMember<double>(parameters.receiver, entry.key);
    case ParameterGroup::kBeam:
    case ParameterGroup::kTransmit:
      return ParameterMember<double>(parameters.beam, entry.key);
    case ParameterGroup::kPulse:
      return ParameterMember<double>(parameters.pulse, entry.key);
    case ParameterGroup::kMirror:
      return ParameterMember<double>(parameters.mirrors.at(material_names[entry.mirror]), entry.key);
    case ParameterGroup::kGsab:
      return ParameterMember<double>(parameters.materials.at(material_names[entry.material]).gsab, entry.key);
    default:
      return parameters.source_level_db;
  }
}

void StorePaperParameters(const sim::PaperParameters<double>& fitted,
                          const std::vector<std::string>& material_names, ParameterSet& parameters) {
  parameters.source_level_db = fitted.source_level_db;
  parameters.display = fitted.display;
  parameters.jitter = fitted.jitter;
  for (std::size_t i = 0; i < material_names.size(); ++i) {
    parameters.materials[material_names[i]].gsab = fitted.materials[i];
  }
}

}  // namespace sonarcal::calib
