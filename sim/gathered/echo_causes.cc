#include "sim/gathered/echo_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "sim/gathered/ghost_echoes.h"
#include "sim/gathered/power_response.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/beam_pattern.h"
#include "sim/physics/echo_power_model.h"

namespace sonarcal::sim {
namespace {

// Main lobe of a response: from its peak, which several equal weights may share, to where it first stops
// falling on either side. All other weights are set to 0, so the window keeps its length.
ResponseWindow MainLobe(ResponseWindow window) {
  std::vector<double>& weight = window.weight;
  const auto peak = std::max_element(weight.begin(), weight.end());
  if (peak == weight.end()) return window;
  const auto goes_on = [top = *peak](double from, double to) {
    return to < from || (from == top && to == top);
  };
  auto right = peak;
  while (right + 1 != weight.end() && goes_on(*right, *(right + 1))) ++right;
  std::fill(right + 1, weight.end(), 0.0);
  auto left = peak;
  while (left != weight.begin() && goes_on(*left, *(left - 1))) --left;
  std::fill(weight.begin(), left, 0.0);
  return window;
}

// Echoes for which `keep` is true.
template <typename Keep>
EchoList Only(const EchoList& echoes, const Keep& keep) {
  EchoList kept = echoes;
  std::size_t count = 0;
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (!keep(i)) continue;
    kept.ray[count] = echoes.ray[i];
    kept.material[count] = echoes.material[i];
    kept.range_m[count] = echoes.range_m[i];
    kept.azimuth_rad[count] = echoes.azimuth_rad[i];
    kept.elevation_rad[count] = echoes.elevation_rad[i];
    kept.incidence_rad[count] = echoes.incidence_rad[i];
    kept.solid_angle_sr[count] = echoes.solid_angle_sr[i];
    if (!echoes.weight.empty()) kept.weight[count] = echoes.weight[i];
    ++count;
  }
  for (auto* floats :
       {&kept.range_m, &kept.azimuth_rad, &kept.elevation_rad, &kept.incidence_rad, &kept.solid_angle_sr})
    floats->resize(count);
  kept.ray.resize(count);
  kept.material.resize(count);
  if (!echoes.weight.empty()) kept.weight.resize(count);
  return kept;
}

// Power of each cell by material: echoes x curve, source level and gain included.
std::vector<double> CellPowers(const EchoPower& echoes, const EchoPowerModel& model) {
  const std::size_t materials = model.materials().size();
  std::vector<double> curve;
  for (const GsabParameters<double>& gsab : model.materials()) {
    for (int node = 0; node < kIncidenceNodes; ++node)
      curve.push_back(GsabPower(gsab, IncidenceOfNodeDeg(node)));
  }
  const double level = model.level();
  std::vector<double> powers(echoes.cells.size() * materials, 0.0);
  for (std::size_t cell = 0; cell < echoes.cells.size(); ++cell) {
    for (std::uint32_t e = echoes.cells[cell].first_entry; e < echoes.cells[cell].last_entry; ++e) {
      const EchoPower::Entry& entry = echoes.entries[e];
      powers[cell * materials + entry.node / kIncidenceNodes] += level * entry.power * curve[entry.node];
    }
  }
  return powers;
}

// Computes the causes of one pose step by step.
class CauseFinder {
 public:
  CauseFinder(const Simulator& simulator, const Pose& pose, const ParameterSet& parameters)
      : simulator_(simulator),
        pose_(pose),
        parameters_(parameters),
        geometry_{simulator.sonar(), simulator.absorption_db_per_m()},
        materials_(simulator.caster().material_names()),
        model_(geometry_, parameters, materials_),
        gain_(GainByBin(geometry_, parameters)) {}

  EchoCauses Find() {
    Add(CauseKind::kNoise, "noise", NoiseFloorPower(geometry_, parameters_));
    AddDirect();
    AddGhosts();
    return std::move(found_);
  }

 private:
  void Add(CauseKind kind, const std::string& name, Grid<double> power) {
    const auto values = power.values();
    const bool any = std::any_of(values.begin(), values.end(), [](double value) { return value > 0.0; });
    if (!any && kind != CauseKind::kNoise) return;
    found_.causes.push_back({.kind = kind, .name = name, .power = std::move(power)});
  }

  PowerResponse Response(const std::vector<double>& columns, int steps, bool main_lobe) const {
    std::vector<ResponseWindow> azimuth =
        AzimuthWindows(simulator_.sonar(), parameters_, columns, ResponseOf::kPower);
    if (main_lobe) {
      for (ResponseWindow& window : azimuth) window = MainLobe(std::move(window));
    }
    return {simulator_.sonar().axes.range_bins, steps, std::move(azimuth),
            PulseWindow(simulator_.sonar(), parameters_, steps, ResponseOf::kPower)};
  }

  // Image k of a stack, gain included.
  Grid<double> ImageOf(const ImageStack& stack, int k) const {
    const int beams = simulator_.sonar().axes.beam_count();
    Grid<double> image(simulator_.sonar().axes.range_bins, beams);
    for (int bin = 0; bin < image.rows(); ++bin) {
      for (int beam = 0; beam < beams; ++beam)
        image(bin, beam) =
            gain_[bin] * stack.values[(static_cast<std::size_t>(bin) * beams + beam) * stack.count + k];
    }
    return image;
  }

  void AddDirect() {
    const EchoList all = simulator_.TraceEchoes(pose_);
    const auto end_rad = static_cast<float>(MainLobeEndRad(model_.elevation()));
    const int count = static_cast<int>(materials_.size());
    Grid<double> in_lobes(simulator_.sonar().axes.range_bins, simulator_.sonar().axes.beam_count());
    for (const bool main_elevation : {true, false}) {
      const EchoPower echoes = GatherEchoPower(
          Only(all,
               [&](std::size_t i) { return (std::abs(all.elevation_rad[i]) <= end_rad) == main_elevation; }),
          simulator_.fan(), geometry_, parameters_);
      const std::vector<double> cells = CellPowers(echoes, model_);
      const PowerResponse whole = Response(echoes.column_azimuth_rad, echoes.range_steps, false);
      const PowerResponse main = Response(echoes.column_azimuth_rad, echoes.range_steps, true);
      const ImageStack through_whole = whole.Apply(echoes, cells, count);
      const ImageStack through_main = main.Apply(echoes, cells, count);
      for (int material = 0; material < count; ++material) {
        Grid<double> power = ImageOf(through_main, material);
        const Grid<double> heard = ImageOf(through_whole, material);
        for (std::size_t i = 0; i < power.size(); ++i)
          in_lobes.values()[i] += std::max(0.0, heard.values()[i] - power.values()[i]);
        Add(main_elevation ? CauseKind::kMaterial : CauseKind::kElevationLobe,
            main_elevation ? materials_[material]
                           : fmt::format("{}, through a side lobe in elevation", materials_[material]),
            std::move(power));
      }
      AddLobes(echoes, cells, whole, main);
    }
    Add(CauseKind::kAzimuthLobe, "side lobe in azimuth", std::move(in_lobes));
    if (found_.causes.back().kind == CauseKind::kAzimuthLobe) found_.lobe_of = StrongestLobes();
  }

  // Stores the power that each beam receives from every column through side lobes, bin by bin.
  void AddLobes(const EchoPower& echoes, const std::vector<double>& cells, const PowerResponse& whole,
                const PowerResponse& main) {
    const PolarAxes& axes = simulator_.sonar().axes;
    columns_ = echoes.column_azimuth_rad;
    if (by_column_.empty()) by_column_.assign(static_cast<std::size_t>(axes.range_bins) * echoes.cols, 0.0);
    const std::vector<std::size_t> row_start = RowStarts(echoes);
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      const auto [first_row, last_row] = whole.RowsOfBin(bin);
      for (std::size_t i = row_start[first_row]; i < row_start[last_row]; ++i) {
        double power = 0.0;
        for (std::size_t material = 0; material < materials_.size(); ++material)
          power += cells[i * materials_.size() + material];
        by_column_[static_cast<std::size_t>(bin) * echoes.cols + echoes.cells[i].col] +=
            whole.PulseWeight(bin, echoes.cells[i].row) * power;
      }
    }
    windows_.clear();
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      ResponseWindow lobes = whole.azimuth(beam);
      for (std::size_t i = 0; i < lobes.weight.size(); ++i) {
        if (main.azimuth(beam).weight[i] > 0.0) lobes.weight[i] = 0.0;
      }
      windows_.push_back(std::move(lobes));
    }
  }

  Grid<int> StrongestLobes() const {
    const PolarAxes& axes = simulator_.sonar().axes;
    const int beams = axes.beam_count();
    std::vector<int> beam_of_column;
    for (const double azimuth_rad : columns_)
      beam_of_column.push_back(std::clamp(axes.BeamAt(azimuth_rad), 0, beams - 1));
    Grid<int> strongest(axes.range_bins, beams);
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      const double* line = &by_column_[static_cast<std::size_t>(bin) * columns_.size()];
      for (int beam = 0; beam < beams; ++beam) {
        double most = 0.0;
        strongest(bin, beam) = -1;
        const ResponseWindow& window = windows_[beam];
        for (std::size_t i = 0; i < window.weight.size(); ++i) {
          const double power = window.weight[i] * line[window.first + i];
          if (!(power > most)) continue;
          most = power;
          strongest(bin, beam) = beam_of_column[window.first + i];
        }
      }
    }
    return strongest;
  }

  // Multipath echoes, grouped by the set of mirrors on their path.
  void AddGhosts() {
    const GhostList ghosts = simulator_.TraceGhosts(pose_, parameters_);
    std::map<std::set<std::uint16_t>, GhostList> by_mirrors;
    for (const GhostEcho& echo : ghosts.echoes) {
      const GhostWay way = WayOf(echo);
      GhostList& list = by_mirrors[{way.begin(), way.end()}];
      list.echoes.push_back(echo);
    }
    for (auto& [mirrors, list] : by_mirrors) {
      list.material_names = ghosts.material_names;
      EchoList none;
      none.cols = simulator_.fan().cols();
      none.material_names = materials_;
      ScatterMap scatter = MakeScatterMap(none, simulator_.fan(), geometry_, parameters_);
      sonarcal::sim::AddGhosts(list, geometry_, parameters_, scatter);
      Add(CauseKind::kGhost,
          fmt::format("ghost by {}", WayName(GhostWay(mirrors.begin(), mirrors.end()), materials_)),
          EchoPowerImage(scatter, geometry_, parameters_));
    }
  }

  const Simulator& simulator_;
  const Pose& pose_;
  const ParameterSet& parameters_;
  AcousticGeometry geometry_;
  const std::vector<std::string>& materials_;
  EchoPowerModel model_;
  std::vector<double> gain_;
  std::vector<double> columns_;
  std::vector<double> by_column_;        // power of each column in each bin
  std::vector<ResponseWindow> windows_;  // per beam, side lobes only
  EchoCauses found_;
};

}  // namespace

Grid<int> EchoCauses::Largest() const {
  Grid<int> largest(causes.front().power.rows(), causes.front().power.cols());
  for (std::size_t i = 0; i < largest.size(); ++i) {
    for (std::size_t k = 1; k < causes.size(); ++k) {
      if (causes[k].power.values()[i] > causes[largest.values()[i]].power.values()[i])
        largest.values()[i] = static_cast<int>(k);
    }
  }
  return largest;
}

EchoCauses CausesOf(const Simulator& simulator, const Pose& world_from_sonar,
                    const ParameterSet& parameters) {
  return CauseFinder(simulator, world_from_sonar, parameters).Find();
}

}  // namespace sonarcal::sim
