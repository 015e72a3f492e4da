#include "tests/sim/reference_paper_model.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <set>
#include <utility>

namespace sonarcal::testing::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a ray is within a convex body, and the normals of the walls it comes and goes by.
struct Stay {
  double in = -kInfinity;
  double out = kInfinity;
  Vector3d normal_in = Vector3d::Zero();
  Vector3d normal_out = Vector3d::Zero();

  bool none() const { return !(in < out); }
  bool Holds(double t) const { return in < t && t < out; }
};

Stay StayWithin(const Convex& body, const Vector3d& from, const Vector3d& along) {
  Stay stay;
  const auto come = [&](double t, const Vector3d& normal) {
    if (t > stay.in) stay.in = t, stay.normal_in = normal;
  };
  const auto go = [&](double t, const Vector3d& normal) {
    if (t < stay.out) stay.out = t, stay.normal_out = normal;
  };
  for (const HalfSpace& plane : body.planes) {
    const double speed = plane.normal.dot(along);
    const double room = plane.offset - plane.normal.dot(from);
    if (speed > 0.0) {
      go(room / speed, plane.normal);
    } else if (speed < 0.0) {
      come(room / speed, plane.normal);
    } else if (room < 0.0) {
      stay.out = -kInfinity;
    }
  }
  for (const Round& round : body.rounds) {
    const auto across = [&](const Vector3d& v) -> Vector3d { return v - v.dot(round.axis) * round.axis; };
    const Vector3d offset = across(from - round.middle);
    const Vector3d step = across(along);
    const double a = step.squaredNorm();
    const double b = offset.dot(step);
    const double c = offset.squaredNorm() - round.radius * round.radius;
    const double under_root = b * b - a * c;
    if (a == 0.0 || under_root <= 0.0) {
      if (a > 0.0 || c > 0.0) stay.out = -kInfinity;
      continue;
    }
    const double t_in = (-b - std::sqrt(under_root)) / a;
    const double t_out = (-b + std::sqrt(under_root)) / a;
    come(t_in, (offset + t_in * step) / round.radius);
    go(t_out, (offset + t_out * step) / round.radius);
  }
  return stay;
}

void MeetSolid(const Solid& solid, const Vector3d& from, const Vector3d& along, Hit& hit) {
  const Vector3d to_middle = solid.middle - from;
  const double ahead = to_middle.dot(along);
  if (ahead < -solid.reach || to_middle.squaredNorm() - ahead * ahead > solid.reach * solid.reach) return;
  if (ahead - solid.reach > hit.range_m) return;
  const Stay stay = StayWithin(solid.outside, from, along);
  if (stay.none()) return;
  const auto meet = [&](double t, const Vector3d& normal) {
    if (t > 0.0 && t < hit.range_m) hit = {t, normal, solid.material};
  };
  Stay bore;
  bore.out = -kInfinity;
  if (!solid.bore.planes.empty() || !solid.bore.rounds.empty()) bore = StayWithin(solid.bore, from, along);
  if (!bore.Holds(stay.in)) meet(stay.in, stay.normal_in);
  if (!bore.Holds(stay.out)) meet(stay.out, stay.normal_out);
  if (bore.none()) return;
  if (stay.Holds(bore.in)) meet(bore.in, bore.normal_in);
  if (stay.Holds(bore.out)) meet(bore.out, bore.normal_out);
}

Convex Moved(Convex body, const Eigen::Isometry3d& to) {
  for (HalfSpace& plane : body.planes) {
    plane.normal = to.linear() * plane.normal;
    plane.offset += plane.normal.dot(to.translation());
  }
  for (Round& round : body.rounds) {
    round.middle = to * round.middle;
    round.axis = to.linear() * round.axis;
  }
  return body;
}

// The walls of a prism, or a round wall; without the ends.
Convex Wall(const Vector3d& base, const Vector3d& axis, double radius, int sides) {
  if (sides == 0) return {.planes = {}, .rounds = {{base, axis, radius}}};
  // Two coordinate axes across: a corner lies in the direction of the first.
  int along = 0;
  axis.cwiseAbs().maxCoeff(&along);
  const Vector3d u = Vector3d::Unit((along + 1) % 3);
  const Vector3d v = Vector3d::Unit((along + 2) % 3);
  Convex wall;
  for (int side = 0; side < sides; ++side) {
    const double angle = 2.0 * std::numbers::pi * (side + 0.5) / sides;
    const Vector3d normal = std::cos(angle) * u + std::sin(angle) * v;
    wall.planes.push_back({normal, normal.dot(base) + radius * std::cos(std::numbers::pi / sides)});
  }
  return wall;
}

}  // namespace

Hit World::Meet(const Vector3d& from, const Vector3d& along) const {
  Hit hit;
  for (const Rectangle& r : rectangles) {
    const Vector3d normal = r.side_u.cross(r.side_v).normalized();
    const double t = normal.dot(r.corner - from) / normal.dot(along);
    if (!(t > 0.0 && t < hit.range_m)) continue;
    const Vector3d at = from + t * along - r.corner;
    const double u = at.dot(r.side_u) / r.side_u.squaredNorm();
    const double v = at.dot(r.side_v) / r.side_v.squaredNorm();
    if (u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0) hit = {t, normal, r.material};
  }
  for (const Solid& solid : solids) MeetSolid(solid, from, along, hit);
  return hit;
}

void World::Add(Solid solid, const Eigen::Isometry3d& world_from_solid) {
  solid.outside = Moved(std::move(solid.outside), world_from_solid);
  solid.bore = Moved(std::move(solid.bore), world_from_solid);
  solid.middle = world_from_solid * solid.middle;
  solids.push_back(std::move(solid));
}

Solid Box(const Vector3d& low, const Vector3d& high, int material) {
  Solid box{
      .outside = {}, .material = material, .middle = 0.5 * (low + high), .reach = 0.5 * (high - low).norm()};
  for (int axis = 0; axis < 3; ++axis) {
    box.outside.planes.push_back({Vector3d::Unit(axis), high[axis]});
    box.outside.planes.push_back({-Vector3d::Unit(axis), -low[axis]});
  }
  return box;
}

Solid Ball(const Vector3d& middle, double radius, int material) {
  return {.outside = {.planes = {}, .rounds = {{middle, Vector3d::Zero(), radius}}},
          .material = material,
          .middle = middle,
          .reach = radius};
}

Solid Cylinder(const Vector3d& base, const Vector3d& axis, double radius, int sides, int material,
               double inner_radius) {
  const double length = axis.norm();
  const Vector3d unit = axis / length;
  Solid solid{.outside = Wall(base, unit, radius, sides),
              .material = material,
              .middle = base + 0.5 * axis,
              .reach = std::hypot(0.5 * length, radius)};
  solid.outside.planes.push_back({unit, unit.dot(base) + length});
  solid.outside.planes.push_back({-unit, -unit.dot(base)});
  if (inner_radius > 0.0) solid.bore = Wall(base, unit, inner_radius, sides);
  return solid;
}

void AddMockup(World& world, const Eigen::Isometry3d& world_from_mockup) {
  constexpr double kRelief = 0.08;
  constexpr double kSunk = 0.005;
  constexpr int kSides = 16;
  constexpr double kCore = 0.5 - kRelief;  // half its width
  constexpr double kTop = 1.5 - kRelief;   // of the core
  constexpr double kPost = 0.12;
  constexpr double kPanelWidth = 1.0 - 2.0 * kPost;
  constexpr double kPanelHeight = 1.5 - 2.0 * kPost;
  const auto add = [&](const Solid& solid) { world.Add(solid, world_from_mockup); };

  add(Box({-kCore, -kCore, 0.0}, {kCore, kCore, kTop}, kMockup));
  for (const double x : {-0.5, 0.5 - kPost}) {
    for (const double y : {-0.5, 0.5 - kPost}) add(Box({x, y, 0.0}, {x + kPost, y + kPost, 1.5}, kMockup));
  }
  // Level beams between the posts, along x and along y.
  for (const double z : {kSunk, 1.5 - kSunk - kPost}) {
    for (const double y : {-0.5 + kSunk, 0.5 - kPost + kSunk}) {
      const Vector3d low(-0.44, y, z);
      const Vector3d high(0.44, y + kPost - 2.0 * kSunk, z + kPost);
      add(Box(low, high, kMockup));
      add(Box({low.y(), low.x(), low.z()}, {high.y(), high.x(), high.z()}, kMockup));
    }
  }
  // The well's head.
  const Vector3d head(0.0, 0.0, kTop - kSunk);
  const Vector3d up = Vector3d::UnitZ();
  add(Cylinder(head, (0.7 * kRelief + kSunk) * up, 0.3, kSides, kMockup, 0.85 * 0.3));
  add(Cylinder(head, (0.95 * kRelief + kSunk) * up, 0.15, kSides, kMockup));

  // Sides, each in its own frame: x to the right, y up and z outwards from the middle of the core's face.
  const auto panel_to = [&](int side) {
    Eigen::Isometry3d to = world_from_mockup;
    to.rotate(Eigen::AngleAxisd(0.5 * std::numbers::pi * side, Vector3d::UnitZ()));
    to.translate(Vector3d(0.0, -kCore, 0.75));
    to.rotate(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitX()));
    return to;
  };
  const auto bar = [&](int side, double x, double y, double width, double height, double rise) {
    world.Add(Box({x - 0.5 * width, y - 0.5 * height, -kSunk},
                  {x + 0.5 * width, y + 0.5 * height, rise * kRelief}, kMockup),
              panel_to(side));
  };
  const auto pipe = [&](int side, const Vector3d& base, const Vector3d& axis, double radius, double inner) {
    world.Add(Cylinder(base, axis, radius, kSides, kMockup, inner), panel_to(side));
  };
  const auto stub = [&](int side, double x, double y, double radius, double inner, double rise) {
    pipe(side, {x, y, -kSunk}, (rise * kRelief + kSunk) * up, radius, inner);
  };

  // A square rim about a cross.
  const double square = 0.8 * kPanelWidth;
  const double thick = 0.1 * square;
  const double arm = 0.5 * (square - thick);
  for (const double sign : {-1.0, 1.0}) {
    bar(0, 0.0, sign * arm, square, thick, 0.8);
    bar(0, sign * (arm - kSunk), 0.0, thick, square - 1.5 * thick, 0.75);
  }
  bar(0, 0.0, 0.0, 0.6 * square, 1.5 * thick, 0.9);
  bar(0, 0.0, 0.0, 1.5 * thick, 0.6 * square, 0.85);

  // Five pipes behind two clamps.
  const double pipe_radius = 0.45 * kRelief;
  for (int i = -2; i <= 2; ++i) {
    pipe(1, {i * kPanelWidth / 5, -0.45 * kPanelHeight, 0.5 * kRelief},
         0.9 * kPanelHeight * Vector3d::UnitY(), pipe_radius, 0.0);
  }
  for (const double sign : {-1.0, 1.0})
    bar(1, 0.0, sign * 0.3 * kPanelHeight, 0.95 * kPanelWidth, pipe_radius, 0.5);

  // A flange with a stub in it, and four ports.
  const double flange = 0.25 * kPanelWidth;
  stub(2, 0.0, 0.0, flange, 0.7 * flange, 0.9);
  stub(2, 0.0, 0.0, 0.35 * flange, 0.0, 0.95);
  for (const double x : {-0.35, 0.35}) {
    for (const double y : {-0.36, 0.36})
      stub(2, x * kPanelWidth, y * kPanelHeight, 0.4 * flange, 0.2 * flange, 0.6);
  }

  // Ribs.
  const double pitch = kPanelHeight / 6;
  for (int i = 0; i < 6; ++i) bar(3, 0.0, (i - 2.5) * pitch, 0.94 * kPanelWidth, 0.35 * pitch, 0.8);
}

World Mockup() {
  World world;
  AddMockup(world, Eigen::Isometry3d::Identity());
  return world;
}

World PaperTank() {
  World world;
  const Vector3d x(12.0, 0.0, 0.0), y(0.0, 10.0, 0.0), z(0.0, 0.0, 1.5);
  const Vector3d origin = Vector3d::Zero();
  world.rectangles = {{origin, x, y, kFloor},
                      {origin, x, z, kWall},
                      {origin, y, z, kWall},
                      {x, y, z, kWall},
                      {y, x, z, kWall}};
  const auto stand = [&](double at_x, double at_y, double yaw_deg) {
    Eigen::Isometry3d to = Eigen::Isometry3d::Identity();
    to.translate(Vector3d(at_x, at_y, 0.0));
    to.rotate(Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180.0, Vector3d::UnitZ()));
    AddMockup(world, to);
  };
  stand(4.8, 6.4, 12.0);
  stand(7.2, 6.2, -75.0);
  return world;
}

double AbsorptionDbPerM(double frequency_khz, const Settings& s) {
  const double f2 = frequency_khz * frequency_khz;
  const double boron = 0.78 * std::sqrt(s.salinity_ppt / 35.0) * std::exp(s.temperature_c / 26.0);
  const double magnesium = 42.0 * std::exp(s.temperature_c / 17.0);
  const double db_per_km = 0.106 * (boron * f2 / (boron * boron + f2)) * std::exp((s.ph - 8.0) / 0.56) +
                           0.52 * (1.0 + s.temperature_c / 43.0) * (s.salinity_ppt / 35.0) *
                               (magnesium * f2 / (magnesium * magnesium + f2)) * std::exp(-s.depth_km / 6.0) +
                           0.00049 * f2 * std::exp(-(s.temperature_c / 27.0 + s.depth_km / 17.0));
  return db_per_km / 1000.0;
}

Frame::Frame(const World& world, const Sonar& sonar, const Settings& settings, Spread spread, int cols,
             int rows, const Eigen::Isometry3d& world_from_sonar)
    : world_(world),
      sonar_(sonar),
      settings_(settings),
      spread_(spread),
      rows_(rows),
      world_from_sonar_(world_from_sonar),
      alpha_db_per_m_(AbsorptionDbPerM(sonar.frequency_khz, settings)) {
  // Edges midway between centres, the outer two as far out as the next are in.
  const std::vector<double>& centre = sonar_.beam_deg;
  std::vector<double> edge(beams() + 1);
  for (int beam = 1; beam < beams(); ++beam)
    edge[beam] = 0.5 * (centre[beam - 1] + centre[beam]) * std::numbers::pi / 180.0;
  edge[0] = 2.0 * centre.front() * std::numbers::pi / 180.0 - edge[1];
  edge[beams()] = 2.0 * centre.back() * std::numbers::pi / 180.0 - edge[beams() - 1];

  rays_of_beam_.assign(beams(), 0);
  const auto add = [&](double azimuth_rad, int beam) {
    azimuth_rad_.push_back(azimuth_rad);
    beam_of_col_.push_back(beam);
    rays_of_beam_[beam] += rows_;
  };
  if (spread_ == Spread::kBeams) {
    const int each = (cols + beams() - 1) / beams();
    for (int beam = 0; beam < beams(); ++beam) {
      for (int i = 0; i < each; ++i) add(edge[beam] + (i + 0.5) / each * (edge[beam + 1] - edge[beam]), beam);
    }
  } else {
    const double left = std::tan(edge.front());
    const double focal = cols / (std::tan(edge.back()) - left);
    int beam = 0;
    for (int col = 0; col < cols; ++col) {
      const double azimuth_rad = std::atan(left + (col + 0.5) / focal);
      while (beam + 1 < beams() && azimuth_rad >= edge[beam + 1]) ++beam;
      add(azimuth_rad, beam);
    }
  }

  sum_.assign(static_cast<std::size_t>(bins()) * beams(), 0.0);
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < this->cols(); ++col) {
      const Vector3d along = Direction(row, col, 0.0, 0.0);
      const Hit hit = world_.Meet(world_from_sonar_.translation(), along);
      const int bin = Bin(hit.range_m);
      if (bin < 0) continue;
      const int beam = beam_of_col_[col];
      sum_[static_cast<std::size_t>(bin) * beams() + beam] +=
          Share(hit, std::abs(along.dot(hit.normal)), beam);
    }
  }
}

Vector3d Frame::Direction(int row, int col, double right_rad, double up_rad) const {
  const double half_rad = 0.5 * sonar_.elevation_deg * std::numbers::pi / 180.0;
  const double down = (row + 0.5) / rows_;  // 0 .. 1
  Vector3d in_sonar;
  if (spread_ == Spread::kFrustum) {
    in_sonar = Vector3d(std::tan(azimuth_rad_[col]) + right_rad, 1.0,
                        (1.0 - 2.0 * down) * std::tan(half_rad) + up_rad)
                   .normalized();
  } else {
    const double azimuth = azimuth_rad_[col] + right_rad;
    const double elevation = (1.0 - 2.0 * down) * half_rad + up_rad;
    in_sonar = Vector3d(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
                        std::sin(elevation));
  }
  return world_from_sonar_.linear() * in_sonar;
}

int Frame::Bin(double range_m) const {
  const double bin =
      std::floor((range_m - sonar_.range_min_m) * bins() / (sonar_.range_max_m - sonar_.range_min_m));
  return bin >= 0.0 && bin < bins() ? static_cast<int>(bin) : -1;
}

// Eqs. 11 to 22: full scale times s over the rays of the beam.
double Frame::Share(const Hit& hit, double cosine, int beam) const {
  const Gsab& g = settings_.materials[hit.material];
  const double delta = std::acos(std::min(1.0, cosine)) * 180.0 / std::numbers::pi;
  const double gsab = g.a * std::exp(-delta * delta / (2.0 * g.b_deg * g.b_deg)) +
                      g.c * std::pow(cosine, g.d) +
                      g.e * std::exp(-delta * delta / (2.0 * g.f_deg * g.f_deg));
  const double one_way_db = 20.0 * std::log10(hit.range_m) + alpha_db_per_m_ * hit.range_m;
  const double snr_db = settings_.source_level_db - 2.0 * one_way_db + 10.0 * std::log10(gsab);
  const double s = (snr_db - settings_.db_min) / (settings_.db_max - settings_.db_min);
  return settings_.full_scale * s / rays_of_beam_[beam];
}

double Frame::Grey(int bin, int beam) const {
  return std::clamp(sum_[static_cast<std::size_t>(bin) * beams() + beam], 0.0, settings_.full_scale);
}

std::vector<double> Frame::Doubt(int beam, double doubt_rad, double doubt_m, int* doubtful) const {
  const Vector3d from = world_from_sonar_.translation();
  std::vector<double> doubt(bins(), 0.0);
  for (int col = 0; col < cols(); ++col) {
    if (beam_of_col_[col] != beam) continue;
    for (int row = 0; row < rows_; ++row) {
      std::set<int> landings;  // bins
      double largest = 0.0;
      double smallest = kInfinity;
      const auto land = [&](double right_rad, double up_rad) {
        const Vector3d along = Direction(row, col, right_rad, up_rad);
        const Hit hit = world_.Meet(from, along);
        if (hit.material < 0) {
          landings.insert(-1);
          smallest = 0.0;
          return;
        }
        const double cosine = std::abs(along.dot(hit.normal));
        const double shift_m = doubt_m / std::max(cosine, 0.01);
        for (const double sign : {-1.0, 0.0, 1.0}) landings.insert(Bin(hit.range_m + sign * shift_m));
        const double share = Share(hit, cosine, beam);
        largest = std::max(largest, std::abs(share));
        smallest = std::min(smallest, std::abs(share));
      };
      land(0.0, 0.0);
      for (const double right : {-doubt_rad, doubt_rad}) {
        for (const double up : {-doubt_rad, doubt_rad}) land(right, up);
      }
      // At an edge that stays within a bin, only the level is in doubt.
      const double at_stake = landings.size() > 1 ? largest : largest - smallest;
      if (landings.size() > 1) ++*doubtful;
      for (const int bin : landings) {
        if (bin >= 0) doubt[bin] += at_stake;
      }
    }
  }
  return doubt;
}

}  // namespace sonarcal::testing::reference
