#include "sim/scenes/bomb.h"

#include <array>

namespace sonarcal::sim {
namespace {

constexpr double kLengthM = 0.737;

struct Knot {
  double of_length;  // from the tail
  double radius_mm;
};

constexpr std::array<Knot, 29> kKnots = {
    {{0.000, 44.8}, {0.015, 20.3},  {0.030, 41.6},  {0.045, 53.4},  {0.060, 57.9}, {0.080, 67.7},
     {0.100, 75.8}, {0.125, 85.9},  {0.150, 80.6},  {0.180, 85.9},  {0.210, 89.1}, {0.240, 91.7},
     {0.270, 98.2}, {0.300, 103.3}, {0.340, 104.0}, {0.400, 103.2}, {0.460, 98.3}, {0.520, 94.2},
     {0.570, 88.3}, {0.620, 83.5},  {0.660, 73.3},  {0.700, 73.1},  {0.740, 74.9}, {0.780, 69.4},
     {0.830, 69.3}, {0.880, 61.4},  {0.930, 50.4},  {0.970, 30.4},  {1.000, 15.9}}};

}  // namespace

std::vector<ProfilePoint> BombOutline() {
  std::vector<ProfilePoint> outline = {{-0.5 * kLengthM, 0.0}};
  for (const Knot& knot : kKnots)
    outline.push_back({(knot.of_length - 0.5) * kLengthM, 1e-3 * knot.radius_mm});
  outline.push_back({0.5 * kLengthM, 0.0});
  return outline;
}

Scene MakeBomb(double max_edge_m, const std::string& material) {
  constexpr double kRadiusM = 0.104;
  return MakeRevolution(RefineProfile(BombOutline(), max_edge_m), SectorsFor(kRadiusM, max_edge_m, 24), false,
                        material);
}

}  // namespace sonarcal::sim
