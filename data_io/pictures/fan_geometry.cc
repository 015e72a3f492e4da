#include "data_io/pictures/fan_geometry.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::data_io {
namespace {

using Point = Eigen::Vector2d;  // x to the right, y down

double Cross(const Point& a, const Point& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Outermost lit pixels of each row, from the top: the candidates for the hull.
struct Outline {
  std::vector<Point> left;
  std::vector<Point> right;
};

Outline OutlineOf(const Mask& lit) {
  Outline outline;
  for (int row = 0; row < lit.rows(); ++row) {
    const auto pixels = lit.row(row);
    const auto is_lit = [](std::uint8_t value) { return value != 0; };
    const auto first = std::find_if(pixels.begin(), pixels.end(), is_lit);
    if (first == pixels.end()) continue;
    const auto last = std::find_if(pixels.rbegin(), pixels.rend(), is_lit);
    outline.left.emplace_back(first - pixels.begin(), row);
    outline.right.emplace_back(pixels.rend() - last - 1, row);
  }
  return outline;
}

// Andrew's monotone chain. Counter-clockwise with y up, so clockwise in the picture.
std::vector<Point> ConvexHull(std::vector<Point> points) {
  const auto before = [](const Point& a, const Point& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Point> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const Point& point : points) {
      while (hull.size() >= base + 2 &&
             Cross(hull.back() - hull[hull.size() - 2], point - hull[hull.size() - 2]) <= 0.0)
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Side of a fan: x = at + slope y.
struct Side {
  double at = 0.0;
  double slope = 0.0;
  double top_px = 0.0;  // ends of the side
  double bottom_px = 0.0;
};

struct Edge {
  Point a;
  Point b;

  Point Along() const { return (b - a).normalized(); }
  double DistanceTo(const Point& point) const { return std::abs(Cross(Along(), point - a)); }
};

constexpr double kNearSidePx = 1.5;

// True if the edge has the inclination of a side: it runs outwards in the upward direction (smaller y).
bool IsInclined(const Edge& edge, int direction) {
  constexpr double kSteepest = 0.03;  // min slope of a side, 1 in 33: no fan is narrower
  const Point step = edge.b - edge.a;
  return std::abs(step.y()) >= 1.0 && step.x() / -step.y() * direction >= kSteepest;
}

// Longest edge of the hull, or a shorter one that the outline touches clearly more. An edge between two
// distant lit pixels may be long, but the outline does not touch it between them.
std::optional<Edge> TouchedEdge(const std::vector<Point>& hull, const std::vector<Point>& outline,
                                int direction) {
  constexpr std::size_t kMaxEdges = 32;  // longest edges that are compared
  constexpr double kClearlyMore = 1.5;
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Edge edge{hull[i], hull[(i + 1) % hull.size()]};
    if (!IsInclined(edge, direction)) continue;
    // Edges of the far arc are flatter than 45 degrees, except in fans wider than that.
    edges.push_back(edge);
  }
  std::ranges::stable_sort(edges, std::greater<>(),
                           [](const Edge& edge) { return (edge.b - edge.a).norm(); });
  if (edges.size() > kMaxEdges) edges.resize(kMaxEdges);
  std::optional<Edge> best;
  double most = 0.0;
  for (const Edge& edge : edges) {
    const auto touching = static_cast<double>(std::ranges::count_if(
        outline, [&](const Point& point) { return edge.DistanceTo(point) < kNearSidePx; }));
    if (best && touching <= kClearlyMore * most) continue;
    most = touching;
    best = edge;
  }
  return best;
}

// Least-squares line x(y) through points; absent if they lie in one row.
std::optional<Side> LineThrough(const std::vector<Point>& points) {
  if (points.empty()) return std::nullopt;
  Point mean = Point::Zero();
  for (const Point& point : points) mean += point / static_cast<double>(points.size());
  double square = 0.0;
  double product = 0.0;
  for (const Point& point : points) {
    square += (point.y() - mean.y()) * (point.y() - mean.y());
    product += (point.y() - mean.y()) * (point.x() - mean.x());
  }
  if (square < 1.0) return std::nullopt;
  const auto [highest, lowest] =
      std::ranges::minmax(points, {}, [](const Point& point) { return point.y(); });
  const double slope = product / square;
  return Side{mean.x() - slope * mean.y(), slope, highest.y(), lowest.y()};
}

std::vector<Point> PointsNear(const std::vector<Point>& points, const Edge& edge) {
  std::vector<Point> near;
  std::ranges::copy_if(points, std::back_inserter(near),
                       [&](const Point& point) { return edge.DistanceTo(point) < kNearSidePx; });
  return near;
}

// Distance of a point from a line, positive to the outside: `direction` -1 is to the left.
double DistanceBeyond(const Edge& line, const Point& point, int direction) {
  const Point along = line.Along();
  return (along.y() > 0.0 ? -direction : direction) * Cross(along, point - line.a);
}

// Number of points that touch the line, less twice the number of points beyond it.
std::ptrdiff_t ScoreOf(const Edge& line, const std::vector<Point>& outline, int direction) {
  std::ptrdiff_t score = 0;
  for (const Point& point : outline) {
    const double distance = DistanceBeyond(line, point, direction);
    if (std::abs(distance) < kNearSidePx) ++score;
    if (distance >= kNearSidePx) score -= 2;
  }
  return score;
}

// Line of the best score among lines through two points of the outline of one side.
std::optional<Edge> MostTouchedLine(const std::vector<Point>& outline, int direction) {
  constexpr std::size_t kMaxPairs = 500;  // of each distance between the two points
  std::optional<Edge> best;
  std::ptrdiff_t most = 0;
  for (const std::size_t part : {2, 3, 5, 8}) {
    const std::size_t apart = outline.size() / part;
    if (apart < 2) continue;
    const std::size_t pairs = outline.size() - apart;
    for (std::size_t i = 0; i < pairs; i += 1 + pairs / kMaxPairs) {
      const Edge line{outline[i], outline[i + apart]};
      if (!IsInclined(line, direction)) continue;
      const std::ptrdiff_t score = ScoreOf(line, outline, direction);
      if (score <= most) continue;
      most = score;
      best = line;
    }
  }
  return best;
}

// Side of the fan from the outermost lit pixels on that side, row by row, and from the hull of all lit
// pixels. `direction` -1 is the left side.
std::optional<Side> FindSide(const std::vector<Point>& outline, const std::vector<Point>& hull,
                             int direction) {
  constexpr double kMuchMore = 2.0;
  const std::optional<Edge> edge = TouchedEdge(hull, outline, direction);
  const std::optional<Edge> line = MostTouchedLine(outline, direction);
  const std::ptrdiff_t score_of_edge = edge ? ScoreOf(*edge, outline, direction) : 0;
  const std::ptrdiff_t score_of_line = line ? ScoreOf(*line, outline, direction) : 0;
  // Text, or spikes of a compressed picture, push the hull off the side: they lie beyond the line.
  if (line && static_cast<double>(score_of_line) > kMuchMore * static_cast<double>(score_of_edge))
    return LineThrough(PointsNear(outline, *line));
  // An edge with points beyond it belongs to the other side. The lit pixels then grow wider downwards.
  if (!edge || score_of_edge < 0) return std::nullopt;
  // All corners of the hull near that edge, with equal weights: the side is straight, its pixels are steps.
  return LineThrough(PointsNear(hull, *edge));
}

// Radius and x_scale of the arc about `apex`: dx^2 / (x_scale r)^2 + dy^2 / r^2 = 1, a least-squares fit to
// the points on it.
struct Arc {
  double radius_px = 0.0;
  double x_scale = 1.0;
};

std::optional<Arc> FitArc(std::vector<Point> points, const Point& apex) {
  constexpr int kRounds = 8;
  constexpr double kNearPx = 1.5;
  Arc arc;
  for (int round = 0; round < kRounds; ++round) {
    if (points.size() < 8) return std::nullopt;
    Eigen::MatrixX2d squares(points.size(), 2);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point from = points[i] - apex;
      squares.row(static_cast<Eigen::Index>(i)) << from.x() * from.x(), from.y() * from.y();
    }
    const double unit = squares.maxCoeff();
    const Eigen::Vector2d found =
        (squares / unit).colPivHouseholderQr().solve(Eigen::VectorXd::Ones(squares.rows()));
    if (!(found.x() > 0.0 && found.y() > 0.0)) return std::nullopt;
    arc = {std::sqrt(unit / found.y()), std::sqrt(found.y() / found.x())};
    // Removes dark places at the edge (points inside the arc) and text (points outside it).
    std::vector<Point> kept;
    for (const Point& point : points) {
      const Point from = point - apex;
      const double radius = std::hypot(from.x() / arc.x_scale, from.y());
      if (std::abs(radius - arc.radius_px) < kNearPx + 4.0 / (1.0 + round)) kept.push_back(point);
    }
    if (kept.size() == points.size() && round > 2) break;
    points = std::move(kept);
  }
  if (points.empty()) return std::nullopt;
  // The uppermost lit pixels lie up to a pixel inside the arc, or more in dark places: a high quantile.
  constexpr double kQuantile = 0.9;
  std::vector<double> radii;
  for (const Point& point : points) {
    const Point from = point - apex;
    radii.push_back(std::hypot(from.x() / arc.x_scale, from.y()));
  }
  arc.radius_px = LowerQuantile(std::move(radii), kQuantile);
  return arc;
}

bool IsLit(const Mask& lit, double x, double y) {
  // To the nearest pixel. Comparisons first: a number too large for an integer must not be converted.
  if (!(x > -0.5 && x < lit.cols() - 0.5 && y > -0.5 && y < lit.rows() - 0.5)) return false;
  return lit(static_cast<int>(std::lround(y)), static_cast<int>(std::lround(x))) != 0;
}

// Pixels of a mask along a ray from the apex, by their distance from it.
class Ray {
 public:
  Ray(const Mask& lit, const FanGeometry& fan, double azimuth_rad)
      : lit_(lit),
        apex_(fan.apex_x_px, fan.apex_y_px),
        step_(fan.x_scale * std::sin(azimuth_rad), -std::cos(azimuth_rad)) {}

  bool IsLitAt(double radius) const {
    return IsLit(lit_, apex_.x() + radius * step_.x(), apex_.y() + radius * step_.y());
  }
  // Radii at which the ray enters the picture from below and leaves it at the top; at least 0.
  double FirstRadius() const { return RadiusAtRow(lit_.rows()); }
  double LastRadius() const { return RadiusAtRow(-1.0); }

 private:
  double RadiusAtRow(double row) const { return std::max(0.0, (row - apex_.y()) / step_.y()); }

  const Mask& lit_;
  Point apex_;
  Point step_;
};

// Up to `max_count` rays, evenly spread over a fraction of the fan's angle. A small picture needs only two
// for each column.
std::vector<Ray> RaysOf(const Mask& lit, const FanGeometry& fan, int max_count, double fraction) {
  const int count = std::min(max_count, 2 * lit.cols());
  std::vector<Ray> rays;
  for (int ray = 0; ray < count; ++ray) {
    rays.emplace_back(lit, fan,
                      RadFromDeg(fan.half_angle_deg) * fraction * (2.0 * (ray + 0.5) / count - 1.0));
  }
  return rays;
}

constexpr double kWithoutSides = 0.9;  // fraction of the angle that excludes pixels at the sides

// Radius of the near arc: distance from the apex to the first lit pixel along many rays. Dark places increase
// it and nothing decreases it: a low quantile.
double NearRadius(const Mask& lit, const FanGeometry& fan) {
  constexpr int kRays = 400;
  constexpr double kStepPx = 0.25;
  constexpr double kQuantile = 0.1;
  std::vector<double> radii;
  for (const Ray& ray : RaysOf(lit, fan, kRays, kWithoutSides)) {
    const double last = std::min(fan.radius_max_px, ray.LastRadius());
    for (double radius = std::floor(ray.FirstRadius()); radius < last; radius += kStepPx) {
      if (!ray.IsLitAt(radius)) continue;
      radii.push_back(radius);
      break;
    }
  }
  return radii.empty() ? 0.0 : LowerQuantile(std::move(radii), kQuantile);
}

// Column of a side of the fan in a row: `direction` -1 is the left side.
double SideX(const FanGeometry& fan, int direction, double row) {
  return fan.apex_x_px +
         direction * fan.x_scale * std::tan(RadFromDeg(fan.half_angle_deg)) * (fan.apex_y_px - row);
}

// Fraction of a side's length with a lit pixel up to 3 pixels inside.
double LitShareOfSide(const Mask& lit, const FanGeometry& fan, int direction) {
  constexpr int kSteps = 200;
  const double cosine = std::cos(RadFromDeg(fan.half_angle_deg));
  int lit_steps = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double radius = fan.radius_min_px + (step + 0.5) / kSteps * (fan.radius_max_px - fan.radius_min_px);
    const double row = fan.apex_y_px - radius * cosine;
    const double x = SideX(fan, direction, row);
    for (int inwards = 0; inwards <= 3; ++inwards) {
      if (!IsLit(lit, x - direction * inwards, row)) continue;
      ++lit_steps;
      break;
    }
  }
  return static_cast<double>(lit_steps) / kSteps;
}

// Fraction of directions in which the farthest lit pixel lies within 3 pixels of the far arc.
double LitShareOfFarArc(const Mask& lit, const FanGeometry& fan) {
  constexpr int kRays = 200;
  constexpr double kStepPx = 0.5;
  constexpr double kNearPx = 3.0;
  constexpr double kBeyondPx = 60.0;  // no pixel may be lit beyond this distance
  const std::vector<Ray> rays = RaysOf(lit, fan, kRays, kWithoutSides);
  int near = 0;
  for (const Ray& ray : rays) {
    double radius = fan.radius_max_px + kBeyondPx;
    // No pixel is lit above the picture.
    if (radius > ray.LastRadius()) radius -= kStepPx * std::floor((radius - ray.LastRadius()) / kStepPx);
    for (; radius > fan.radius_max_px - kNearPx; radius -= kStepPx) {
      if (!ray.IsLitAt(radius)) continue;
      if (radius < fan.radius_max_px + kNearPx) ++near;
      break;
    }
  }
  return static_cast<double>(near) / static_cast<double>(rays.size());
}

// Distance from the apex to the farthest lit pixel of each direction between the sides; 0 for a dark
// direction.
std::vector<double> FarthestLit(const Mask& lit, const FanGeometry& fan) {
  constexpr int kRays = 400;
  constexpr double kStepPx = 0.5;
  std::vector<double> radii;
  for (const Ray& ray : RaysOf(lit, fan, kRays, 1.0)) {
    double farthest = 0.0;
    for (double radius = ray.LastRadius(); radius > ray.FirstRadius(); radius -= kStepPx) {
      if (!ray.IsLitAt(radius)) continue;
      farthest = radius;
      break;
    }
    radii.push_back(farthest);
  }
  return radii;
}

// Circle through the farthest lit pixels: the largest radius that some directions share, 0 if there is none.
FanGeometry WithFarthestCircle(const Mask& lit, FanGeometry fan) {
  constexpr std::size_t kMinDirections = 8;  // of up to 400: one bright pixel is no arc
  constexpr double kBandPx = 3.0;
  fan.half_angle_deg = DegFromRad(std::atan(fan.x_scale * std::tan(RadFromDeg(fan.half_angle_deg))));
  fan.x_scale = 1.0;
  std::vector<double> radii = FarthestLit(lit, fan);
  std::ranges::sort(radii, std::greater<>());
  fan.radius_max_px = 0.0;
  for (std::size_t first = 0; first + kMinDirections <= radii.size(); ++first) {
    if (radii[first] - radii[first + kMinDirections - 1] > kBandPx) continue;
    fan.radius_max_px = radii[first];
    break;
  }
  return fan;
}

struct Field {
  const char* name;
  double value;
  double min;
  double max;
};

// The first field that is outside its limits.
std::optional<Field> FaultOf(const FanGeometry& fan) {
  constexpr double kMaxPx = 1e6;
  const Field fields[] = {{"apex_x_px", fan.apex_x_px, -kMaxPx, kMaxPx},
                          {"apex_y_px", fan.apex_y_px, -kMaxPx, kMaxPx},
                          {"radius_min_px", fan.radius_min_px, 0.0, kMaxPx},
                          {"radius_max_px", fan.radius_max_px, fan.radius_min_px + 1.0, kMaxPx},
                          {"half_angle_deg", fan.half_angle_deg, 0.5, 89.0},
                          {"x_scale", fan.x_scale, 0.1, 10.0}};
  for (const Field& field : fields) {
    if (!(field.value >= field.min && field.value <= field.max)) return field;
  }
  return std::nullopt;
}

}  // namespace

void FanGeometry::Validate(const std::string& what) const {
  if (const std::optional<Field> fault = FaultOf(*this)) {
    throw DataError("{}: {} is {}, expected {}..{}", what, fault->name, fault->value, fault->min, fault->max);
  }
}

std::optional<FanGeometry> FindFanGeometry(const Mask& lit) {
  constexpr std::int64_t kMinLitPixels = 100;
  if (CountSet(lit) < kMinLitPixels) return std::nullopt;
  const Outline outline = OutlineOf(lit);
  std::vector<Point> both = outline.left;
  both.insert(both.end(), outline.right.begin(), outline.right.end());
  const std::vector<Point> hull = ConvexHull(std::move(both));
  const std::optional<Side> left = FindSide(outline.left, hull, -1);
  const std::optional<Side> right = FindSide(outline.right, hull, +1);
  if (!left || !right || left->slope <= right->slope) return std::nullopt;
  const double apex_y = (right->at - left->at) / (left->slope - right->slope);
  const Point apex(left->at + left->slope * apex_y, apex_y);
  // Far arc: uppermost lit pixel of each column between the ends of the sides.
  std::vector<Point> far_arc;
  const double first = left->at + left->slope * left->top_px;
  const double last = right->at + right->slope * right->top_px;
  for (int col = std::max(0, static_cast<int>(std::ceil(first)) + 2);
       col < std::min(lit.cols(), static_cast<int>(std::floor(last)) - 1); ++col) {
    for (int row = 0; row < lit.rows(); ++row) {
      if (lit(row, col) == 0) continue;
      far_arc.emplace_back(col, row);
      break;
    }
  }
  const Arc arc = FitArc(far_arc, apex).value_or(Arc{});
  FanGeometry fan{.apex_x_px = apex.x(),
                  .apex_y_px = apex.y(),
                  .radius_min_px = 0.0,
                  .radius_max_px = arc.radius_px,
                  .half_angle_deg = DegFromRad(std::atan(0.5 * (left->slope - right->slope) / arc.x_scale)),
                  .x_scale = arc.x_scale};
  constexpr double kMinVisibleArc = 0.5;
  constexpr double kMaxLoss = 0.2;
  const double visible_arc = LitShareOfFarArc(lit, fan);
  if (visible_arc < kMinVisibleArc) {
    const FanGeometry circle = WithFarthestCircle(lit, fan);
    if (LitShareOfFarArc(lit, circle) + kMaxLoss >= visible_arc) fan = circle;
  }
  if (FaultOf(fan)) return std::nullopt;  // a search along rays of any length would take long
  fan.radius_min_px = NearRadius(lit, fan);
  if (FaultOf(fan)) return std::nullopt;
  return fan;
}

FanVisibility VisibilityOf(const FanGeometry& fan, const Mask& lit) {
  return {.left_side = LitShareOfSide(lit, fan, -1),
          .right_side = LitShareOfSide(lit, fan, +1),
          .far_arc = LitShareOfFarArc(lit, fan)};
}

bool ShowsAnotherFan(const Mask& lit, const FanGeometry& fan) {
  constexpr double kMinLitShare = 0.7;  // fraction of a visible side or arc
  const double far_px = std::max(5.0, 0.02 * lit.cols());
  const std::optional<FanGeometry> own = FindFanGeometry(lit);
  if (!own) return false;
  if (LitShareOfSide(lit, *own, -1) < kMinLitShare || LitShareOfSide(lit, *own, +1) < kMinLitShare)
    return false;
  for (const int direction : {-1, +1}) {
    for (const double radius : {fan.radius_min_px, fan.radius_max_px}) {
      const double row = fan.apex_y_px - radius * std::cos(RadFromDeg(fan.half_angle_deg));
      if (std::abs(SideX(*own, direction, row) - SideX(fan, direction, row)) > far_px) return true;
    }
  }
  const double far_row = own->apex_y_px - own->radius_max_px;
  return std::abs(far_row - (fan.apex_y_px - fan.radius_max_px)) > far_px &&
         LitShareOfFarArc(lit, *own) >= kMinLitShare;
}

}  // namespace sonarcal::data_io
