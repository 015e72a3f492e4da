#include "sim/gathered/ghost_echoes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::sim {
namespace {

// Angles of the nodes for multipath echoes, degrees. Each is among CoarseIncidenceDeg.
const std::vector<double>& NodesDeg(CurvePart part) {
  static const std::vector<double> kTilts = [] {
    std::vector<double> nodes;
    for (double deg = 0.0; deg < 10.0; deg += 0.5) nodes.push_back(deg);
    for (double deg = 10.0; deg < 20.0; deg += 1.0) nodes.push_back(deg);
    for (double deg = 20.0; deg < 40.0; deg += 2.0) nodes.push_back(deg);
    for (double deg = 40.0; deg < 60.0; deg += 4.0) nodes.push_back(deg);
    for (double deg = 60.0; deg <= 90.0; deg += 10.0) nodes.push_back(deg);
    return nodes;
  }();
  static const std::vector<double> kIncidences = {0.0,  10.0, 20.0, 30.0, 40.0, 46.0, 52.0, 58.0, 62.0, 66.0,
                                                  70.0, 74.0, 78.0, 80.0, 82.0, 84.0, 86.0, 88.0, 90.0};
  return part == CurvePart::kPeaks ? kTilts : kIncidences;
}

// Angle between two nodes, given as fine nodes of an EchoPower.
struct OnNodes {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  double of_second = 0.0;
};

OnNodes Between(CurvePart part, double angle_deg) {
  const std::vector<double>& nodes = NodesDeg(part);
  const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, angle_deg);
  const double low = *(above - 1);
  const double high = *above;
  const auto fine = [](double deg) {
    return static_cast<std::uint32_t>(std::lround(deg / kIncidenceStepDeg));
  };
  return {fine(low), fine(high), std::clamp((angle_deg - low) / (high - low), 0.0, 1.0)};
}

}  // namespace

GhostWay WayOf(const GhostEcho& echo) {
  GhostWay way;
  for (const GhostLeg* leg : {&echo.leg, &echo.other}) {
    for (const std::uint16_t mirror : leg->mirror) {
      if (mirror != kNoMirror) way.push_back(mirror);
    }
  }
  std::sort(way.begin(), way.end());
  return way;
}

std::string WayName(const GhostWay& way, const std::vector<std::string>& material_names) {
  std::string name;
  for (std::size_t i = 0; i < way.size();) {
    std::size_t next = i;
    while (next < way.size() && way[next] == way[i]) ++next;
    name += fmt::format("{}{}", name.empty() ? "" : " and ", material_names[way[i]]);
    if (next - i > 1) name += next - i == 2 ? " twice" : fmt::format(" {} times", next - i);
    i = next;
  }
  return name;
}

std::vector<GhostWay> WaysOf(const GhostList& ghosts) {
  std::vector<GhostWay> ways;
  for (const GhostEcho& echo : ghosts.echoes) {
    const GhostWay way = WayOf(echo);
    if (std::find(ways.begin(), ways.end(), way) == ways.end()) ways.push_back(way);
  }
  std::sort(ways.begin(), ways.end());
  return ways;
}

GhostEchoes GatherGhostEchoes(const Simulator& simulator, const GhostList& ghosts,
                              const ParameterSet& parameters) {
  const PolarAxes& axes = simulator.sonar().axes;
  const RayFan& fan = simulator.fan();
  GhostEchoes gathered{.ways = WaysOf(ghosts), .materials = static_cast<int>(ghosts.material_names.size())};
  EchoPower frame;
  frame.range_steps = RangeStepsFor(simulator.sonar(), parameters);
  const FineRows rows(axes, frame.range_steps, PulseLengthM(simulator.sonar(), parameters));
  frame.rows = rows.count;
  frame.cols = fan.cols();
  frame.materials = static_cast<int>(gathered.ways.size()) * gathered.materials * kCurveParts;
  for (int col = 0; col < fan.cols(); ++col) frame.column_azimuth_rad.push_back(fan.AzimuthRad(col));

  const GhostPower power(ghosts.material_names, {simulator.sonar(), simulator.absorption_db_per_m()},
                         parameters);
  const ArrivalGrid grid(frame.column_azimuth_rad, rows);
  std::vector<EchoShare> shares;
  shares.reserve(16 * ghosts.echoes.size());
  for (const GhostEcho& echo : ghosts.echoes) {
    const auto way = static_cast<std::uint32_t>(
        std::find(gathered.ways.begin(), gathered.ways.end(), WayOf(echo)) - gathered.ways.begin());
    const double cosines = std::cos(echo.leg.incidence_rad) * std::cos(echo.other.incidence_rad);
    const std::array<OnNodes, kCurveParts> at = {
        Between(CurvePart::kPeaks, DegFromRad(double{echo.tilt_rad})),
        Between(CurvePart::kSlow, DegFromRad(std::acos(std::sqrt(std::clamp(cosines, 0.0, 1.0)))))};
    const std::uint32_t first = (way * gathered.materials + echo.material) * kCurveParts;
    power.ForEachArrival(echo, power.UnitOneWay(echo), [&](const GhostArrival& arrival) {
      grid.ForEachCell(arrival, [&](int row, int column, double of_cell) {
        if (of_cell == 0.0) return;
        const auto cell = static_cast<std::uint32_t>(row * frame.cols + column);
        for (std::uint32_t part = 0; part < kCurveParts; ++part) {
          const std::uint32_t base = (first + part) * kIncidenceNodes;
          const double of_second = at[part].of_second * of_cell;
          shares.push_back({cell, base + at[part].first, static_cast<float>(of_cell - of_second)});
          if (of_second > 0.0)
            shares.push_back({cell, base + at[part].second, static_cast<float>(of_second)});
        }
      });
    });
  }
  const EchoPower echoes = SumShares(std::move(frame), shares);
  gathered.pixels = GatherPixelEchoes(
      echoes, MakePowerResponse(simulator.sonar(), parameters, echoes.column_azimuth_rad, echoes.range_steps),
      kNegligibleGhost);
  return gathered;
}

}  // namespace sonarcal::sim
