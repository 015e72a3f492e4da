#include "calib/parameters/parameter_catalog.h"

#include <fmt/format.h>

#include <algorithm>
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
    catalog_.push_back({.name = place.name + std::string(info.key),
                        .key = info.key,
                        .unit = std::string(info.unit),
                        .group = transmit ? ParameterGroup::kTransmit : place.group,
                        .material = place.material,
                        .mirror = place.mirror,
                        .index = index,
                        .lower = limits.lower,
                        .upper = limits.upper,
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

}  // namespace

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
                                               const std::vector<char>& mirrors) {
  std::vector<CatalogEntry> catalog =
      CatalogBuilder(EchoModel::kAcoustic, sonar, material_names, mirrors).Build();
  AddPoses(frames, catalog);
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
