#include "sim/scenes/scenes.h"

#include <cmath>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

constexpr double kSonarHeight_m = 0.75;

void RequireWithin(const char* owner, const char* field, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw DataError("{}: {} is {}, expected {}..{}", owner, field, value, low, high);
  }
}

// Radius of the arc of a tangent ogive; its centre lies beside the nose's base.
double OgiveRadiusM(const BodyOptions& options) {
  const double radius_m = 0.5 * options.diameter_m;
  const double nose_m = options.nose_length_m;
  return (radius_m * radius_m + nose_m * nose_m) / (2.0 * radius_m);
}

}  // namespace

void TankOptions::Validate() const {
  for (const auto& [field, value_m] :
       {std::pair{"length_m", length_m}, {"width_m", width_m}, {"depth_m", depth_m}}) {
    RequireWithin("tank", field, value_m, 0.01, 1e4);
  }
  if (!(max_edge_m > 0.0)) throw DataError("tank: max_edge_m is {}, expected more than 0", max_edge_m);
}

TankOptions TankOfSize(SizeVariant size) {
  TankOptions options;
  if (size == SizeVariant::kAlternative) {
    options.length_m = 15.0;
    options.depth_m = 2.0;
  }
  return options;
}

Scene MakeTank(const TankOptions& options) {
  options.Validate();
  const Vector3d x_m = options.length_m * Vector3d::UnitX();
  const Vector3d y_m = options.width_m * Vector3d::UnitY();
  const Vector3d z_m = options.depth_m * Vector3d::UnitZ();
  const Vector3d origin_m = Vector3d::Zero();

  Scene scene = MakePatch(origin_m, x_m, y_m, options.max_edge_m, options.floor_material);
  const auto wall = [&](const Vector3d& corner_m, const Vector3d& side_m) {
    scene.Append(MakePatch(corner_m, z_m, side_m, options.max_edge_m, options.wall_material));
  };
  // Each wall is oriented so that up x along points into the water.
  wall(origin_m, x_m);
  wall(x_m, y_m);
  wall(x_m + y_m, -x_m);
  wall(y_m, -y_m);
  if (options.surface) {
    scene.Append(MakePatch(z_m, y_m, x_m, options.max_edge_m, options.surface_material));
  }
  return scene;
}

Eigen::Isometry3d WorldFromObject(const Place& place) {
  Eigen::Isometry3d world_from_object = Eigen::Isometry3d::Identity();
  world_from_object.translate(Vector3d(place.x_m, place.y_m, 0.0));
  world_from_object.rotate(Eigen::AngleAxisd(place.yaw_rad, Vector3d::UnitZ()));
  return world_from_object;
}

MockupTankOptions MockupTankOfSize(SizeVariant size) {
  MockupTankOptions options;
  options.tank = TankOfSize(size);
  options.mockup = MockupOfSize(size);
  return options;
}

Scene MakeMockupTank(const MockupTankOptions& options) {
  Scene scene = MakeTank(options.tank);
  const Scene mockup = MakeMockup(options.mockup);
  for (const Place& place : options.places) scene.Append(Moved(mockup, WorldFromObject(place)));
  return scene;
}

std::vector<Pose> MockupTankPoses(int set) {
  // Offset from the sonar to the middle of the target: metres to the right, metres ahead.
  struct Offset {
    double right_m;
    double ahead_m;
  };
  static constexpr std::array<Offset, 4> kOneMockup = {Offset{0.0, 3.2}, Offset{-0.6, 4.0}, Offset{0.9, 4.8},
                                                       Offset{0.3, 5.6}};
  static constexpr std::array<Offset, 4> kBothMockups = {Offset{0.0, 5.0}, Offset{0.3, 5.4},
                                                         Offset{-0.3, 5.4}, Offset{0.0, 5.7}};
  if (set < 1 || set > 3) throw DataError("pose set {}, expected 1, 2 or 3", set);

  const std::array<Place, 2> places = MockupTankOptions{}.places;
  const Place middle{0.5 * (places[0].x_m + places[1].x_m), 0.5 * (places[0].y_m + places[1].y_m)};
  const Place& target = set == 3 ? middle : places[set - 1];
  std::vector<Pose> poses;
  for (const auto& [right_m, ahead_m] : set == 3 ? kBothMockups : kOneMockup) {
    poses.push_back({RotationFromYawPitchRoll(0.0, 0.0, 0.0),
                     Vector3d(target.x_m - right_m, target.y_m - ahead_m, kSonarHeight_m)});
  }
  return poses;
}

void BodyOptions::Validate() const {
  RequireWithin("body", "length_m", length_m, 0.01, 100.0);
  RequireWithin("body", "diameter_m", diameter_m, 1e-3, length_m);
  // A tangent ogive shorter than the radius would be wider than the cylinder.
  RequireWithin("body", "nose_length_m", nose_length_m, 0.5 * diameter_m, 0.5 * length_m);
  RequireWithin("body", "tail_length_m", tail_length_m, 1e-3 * length_m, 0.49 * length_m);
  RequireWithin("body", "tail_diameter_m", tail_diameter_m, 1e-3 * diameter_m, diameter_m);
  if (!(max_edge_m > 0.0 && max_edge_m <= length_m)) {
    throw DataError("body: max_edge_m is {}, expected more than 0 and at most the length, {}", max_edge_m,
                    length_m);
  }
}

double BodyRadiusM(const BodyOptions& options, double from_tip_m) {
  const double radius_m = 0.5 * options.diameter_m;
  if (from_tip_m < options.nose_length_m) {
    const double arc_radius_m = OgiveRadiusM(options);
    const double from_base_m = options.nose_length_m - from_tip_m;
    return std::sqrt(arc_radius_m * arc_radius_m - from_base_m * from_base_m) + radius_m - arc_radius_m;
  }
  const double tail_m = options.length_m - from_tip_m;
  if (tail_m >= options.tail_length_m) return radius_m;
  const double tail_radius_m = 0.5 * options.tail_diameter_m;
  return tail_radius_m + (radius_m - tail_radius_m) * tail_m / options.tail_length_m;
}

Scene MakeBody(const BodyOptions& options) {
  options.Validate();
  // Profile from the flat tail to the tip at +x.
  const auto point = [&](double from_tip_m) {
    return ProfilePoint{0.5 * options.length_m - from_tip_m, BodyRadiusM(options, from_tip_m)};
  };
  const std::vector<ProfilePoint> outline = {{-0.5 * options.length_m, 0.0},
                                             point(options.length_m),
                                             point(options.length_m - options.tail_length_m),
                                             point(options.nose_length_m)};
  std::vector<ProfilePoint> profile = RefineProfile(outline, options.max_edge_m);
  // Equal steps along the arc of the nose, so that the steep tip is as finely divided as the rest.
  const double arc_radius_m = OgiveRadiusM(options);
  const double arc_rad = std::asin(options.nose_length_m / arc_radius_m);
  const int steps = static_cast<int>(std::ceil(arc_radius_m * arc_rad / options.max_edge_m));
  for (int step = 1; step < steps; ++step) {
    const double from_base_m = arc_radius_m * std::sin(arc_rad * step / steps);
    profile.push_back(point(options.nose_length_m - from_base_m));
  }
  profile.push_back({0.5 * options.length_m, 0.0});
  return MakeRevolution(profile, SectorsFor(0.5 * options.diameter_m, options.max_edge_m, 24), false,
                        options.material);
}

}  // namespace sonarcal::sim
