#include "sim/acoustic/echo_slopes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/types/error.h"
#include "sim/acoustic/patch_shader.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/patch.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3f;

// Eight numbers of a fine row or a range bin, in one column: of shifts along the three axes, of turns about
// them, and for the image itself and for all echoes that arrive farther away.
struct alignas(32) Lanes {
  std::array<float, 8> value = {};

  Lanes() = default;
  Lanes(const Vector3f& shift, const Vector3f& turn, float seventh, float eighth)
      : value{shift[0], shift[1], shift[2], turn[0], turn[1], turn[2], seventh, eighth} {}
  void Add(float part, const Lanes& other) {
    for (std::size_t k = 0; k < value.size(); ++k) value[k] += part * other.value[k];
  }
};

struct FineTerms {
  Lanes level;    // change of the power
  Lanes azimuth;  // power times the change of azimuth

  void Add(float part, const FineTerms& other) {
    level.Add(part, other.level);
    azimuth.Add(part, other.azimuth);
  }
};

// Terms of a patch.
struct PatchTerms {
  FineTerms fine;
  Lanes range;  // power times the change of range
};

// Terms that the response of a beam weights, and those that its slope weights.
struct BinTerms {
  Lanes by_response;
  Lanes by_slope;
};

// First intersection of a hit.
struct Hit {
  Vector3f direction;          // in the sonar frame
  Vector3f normal;             // towards the sonar
  std::int32_t triangle = -1;  // -1: none
  float range_m = 0.0F;
  float inverse_m = 0.0F;
  float cosine = 1.0F;  // of incidence
  int part = -1;        // that moves alone

  bool exists() const { return triangle >= 0; }
  // Inverse range at which the plane of this hit crosses another direction.
  float InverseRangeAt(const Vector3f& towards) const { return -inverse_m * normal.dot(towards) / cosine; }
};

// Three consecutive rows of hits, in some columns and one more on either side.
class HitRows {
 public:
  HitRows(const RayCaster& caster, const RayFan& fan, const FanHits& hits, const SceneParts& parts,
          const Pose& world_from_sonar, int first_col, int cols)
      : caster_(caster),
        fan_(fan),
        hits_(hits),
        parts_(parts),
        sonar_from_world_(world_from_sonar.rotation.conjugate().toRotationMatrix().cast<float>()),
        first_(first_col - 1),
        begin_(std::max(0, first_)),
        end_(std::min(fan.cols(), first_col + cols + 1)) {
    for (std::vector<Hit>& row : rows_) row.resize(cols + 2);
    for (std::vector<float>& component : direction_) component.resize(cols + 2);
    Load(0, rows_[1]);
    Load(1, rows_[2]);
  }

  const Hit& At(int row, int col) const { return rows_[row - row_ + 1][col - first_]; }

  // Moves on by one row.
  void Advance() {
    std::rotate(rows_.begin(), rows_.begin() + 1, rows_.end());
    ++row_;
    Load(row_ + 1, rows_[2]);
  }

 private:
  void Load(int row, std::vector<Hit>& to) {
    if (row >= fan_.rows()) return;
    fan_.RowDirections(row, begin_, end_ - begin_, Eigen::Matrix3f::Identity(), direction_[0].data(),
                       direction_[1].data(), direction_[2].data());
    for (int col = begin_; col < end_; ++col) {
      Hit& hit = to[col - first_];
      const std::size_t ray = static_cast<std::size_t>(row) * fan_.cols() + col;
      hit.triangle = hits_.triangle[ray];
      if (!hit.exists()) continue;
      const int i = col - begin_;
      hit.direction = {direction_[0][i], direction_[1][i], direction_[2][i]};
      hit.normal = sonar_from_world_ * caster_.TriangleNormal(hit.triangle);
      const float cosine = hit.normal.dot(hit.direction);
      if (cosine > 0.0F) hit.normal = -hit.normal;
      hit.cosine = std::max(std::abs(cosine), 1e-6F);
      hit.range_m = hits_.range_m[ray];
      hit.inverse_m = 1.0F / hit.range_m;
      if (parts_.count > 0) hit.part = parts_.of_triangle[hit.triangle];
    }
  }

  const RayCaster& caster_;
  const RayFan& fan_;
  const FanHits& hits_;
  const SceneParts& parts_;
  Eigen::Matrix3f sonar_from_world_;
  int row_ = 0;
  int first_;  // column of the first element of a row; may be -1
  int begin_;
  int end_;
  std::array<std::vector<Hit>, 3> rows_;
  std::array<std::vector<float>, 3> direction_;
};

// Difference of the inverse ranges of a surface that hides another one and of that one, if the edge of the
// former lies between these rays and `far` is the ray on the latter; otherwise 0. Planes that meet between
// the rays are no edge.
float StepBetween(const Hit& far, const Hit& near) {
  if (near.inverse_m <= far.inverse_m) return 0.0F;
  constexpr float kSame = 1e-4F;  // of the inverse range
  const float at_near = near.inverse_m - far.InverseRangeAt(near.direction);
  const float at_far = near.InverseRangeAt(far.direction) - far.inverse_m;
  const float least = kSame * near.inverse_m;
  if (!(at_near > least && at_far > least)) return 0.0F;
  return near.inverse_m - far.inverse_m;
}

// Change of the share of a patch that is visible, per shift and turn.
struct Uncovered {
  Vector3f shift = Vector3f::Zero();
  Vector3f turn = Vector3f::Zero();

  // Adds the share that an edge crosses if a point at this inverse range moves. `across`: direction in which
  // it uncovers; `turned`: across x direction. `size`: that of the patch along `across`.
  void Add(float inverse_m, const Vector3f& across, const Vector3f& turned, float size) {
    shift += (inverse_m / size) * across;
    turn += turned / size;
  }
};

// Change of the angle at which the planes of two hits meet, from the first hit's direction towards the
// second's, per shift and turn of the first or second plane; zero if they do not meet between the hits.
// `size`: angle between the two directions.
Uncovered MovedCrease(const Hit& hit, const Hit& other, float size, bool first) {
  constexpr float kSame = 1e-5F;  // of the inverse range
  const float at_hit = hit.inverse_m - other.InverseRangeAt(hit.direction);
  const float at_other = hit.InverseRangeAt(other.direction) - other.inverse_m;
  if (!(at_hit * at_other < 0.0F) || std::abs(at_other - at_hit) < kSame * hit.inverse_m) return {};
  const Hit& moved = first ? hit : other;
  const float factor = (first ? -1.0F : 1.0F) * size / (at_other - at_hit) * moved.inverse_m / moved.cosine;
  return {.shift = factor * moved.inverse_m * moved.normal,
          .turn = factor * moved.direction.cross(moved.normal)};
}

// True if the triangle of a hit ends where the plane of another hit meets its plane, as that of a box does
// that stands on a floor. False if it goes on behind the other surface.
bool EndsAtCrease(const Hit& hit, const Hit& other, const Scene& scene, const Pose& world_from_sonar) {
  constexpr float kBeyond = 1e-3F;  // of the way between the hits
  const float at_hit = hit.inverse_m - other.InverseRangeAt(hit.direction);
  const float at_other = hit.InverseRangeAt(other.direction) - other.inverse_m;
  const float part = at_hit / (at_hit - at_other) + kBeyond;
  const Vector3f towards = hit.direction + part * (other.direction - hit.direction);
  const float inverse_m = hit.InverseRangeAt(towards);
  if (!(inverse_m > 0.0F)) return true;
  const Eigen::Vector3d point = world_from_sonar * (towards / inverse_m).cast<double>();
  const Eigen::Vector3i& corner = scene.triangles[hit.triangle];
  const auto vertex = [&](int i) { return Eigen::Vector3d(scene.vertices_m[corner[i]].cast<double>()); };
  const Eigen::Vector3d normal = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d side = vertex((i + 1) % 3) - vertex(i);
    if (normal.dot(side.cross(point - vertex(i))) < 0.0) return true;
  }
  return false;
}

// A response and its slope at the same samples, without the samples at either end that hardly count.
struct SlopedWindow {
  SlopedWindow(const ResponseWindow& power, const ResponseWindow& slope) {
    constexpr double kNegligible = 1e-6;  // of the peak
    const auto counts = [least = kNegligible * *std::ranges::max_element(power.weight)](double of) {
      return of > least;
    };
    const auto begin = std::ranges::find_if(power.weight, counts) - power.weight.begin();
    const auto end = power.weight.rend() - std::find_if(power.weight.rbegin(), power.weight.rend(), counts);
    first = power.first + static_cast<int>(begin);
    weight.assign(power.weight.begin() + begin, power.weight.begin() + end);
    slopes.assign(slope.weight.begin() + begin, slope.weight.begin() + end);
  }

  int first = 0;
  std::vector<float> weight;
  std::vector<float> slopes;
};

// Min difference of ranges whose spread echoes give the slope along range, as a fraction of the pulse.
constexpr double kLeastStep = 0.1;

// Largest step between parts of a patch, as a fraction of the pulse: parts at the step of an image leave a
// ripple whose slope shows.
constexpr double kPart = 0.5;

// Terms by fine row and column of a block.
struct FineMap {
  FineMap(int rows, int columns)
      : cols(columns), terms(static_cast<std::size_t>(rows) * columns), heard(rows, 0) {}

  FineTerms& At(int row, int col) {
    heard[row] = 1;
    return terms[static_cast<std::size_t>(row) * cols + col];
  }

  int cols;
  std::vector<FineTerms> terms;
  std::vector<char> heard;  // per row
};

class SlopeGatherer {
 public:
  SlopeGatherer(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                const AcousticGeometry& geometry, const ParameterSet& parameters, const SceneParts& parts)
      : caster_(caster),
        fan_(fan),
        axes_(geometry.sonar.axes),
        steps_(RangeStepsFor(geometry.sonar, parameters)),
        pulse_(PulseWindow(geometry.sonar, parameters, steps_, ResponseOf::kPower)),
        beyond_((static_cast<int>(pulse_.weight.size()) + steps_ - 1) / steps_),
        traced_(Extended(axes_, beyond_)),
        rows_(traced_, steps_, PulseLengthM(geometry.sonar, parameters)),
        least_step_m_(kLeastStep * PulseLengthM(geometry.sonar, parameters)),
        shader_(fan, EchoPowerModel(geometry, parameters, caster.material_names()),
                ElevationWidthDeg(geometry.sonar, parameters.beam), /*slopes=*/true),
        hits_(caster.Cast(fan, world_from_sonar, traced_.range_max_m)),
        parts_(parts),
        world_from_sonar_(world_from_sonar),
        in_bins_(1 + parts.count,
                 std::vector<BinTerms>(static_cast<std::size_t>(axes_.range_bins) * fan.cols())) {
    rows_.part_m = kPart * PulseLengthM(geometry.sonar, parameters);
  }

  // Terms per range bin and column, bin by bin: for moves of the sonar, then for those of each part.
  std::vector<std::vector<BinTerms>> Run() {
    constexpr int kBlockCols = 16;
    const int blocks = (fan_.cols() + kBlockCols - 1) / kBlockCols;
    tbb::parallel_for(0, blocks, [&](int block) {
      const int first = block * kBlockCols;
      const int cols = std::min(kBlockCols, fan_.cols() - first);
      std::vector<FineMap> fine(in_bins_.size(), FineMap(rows_.count, cols));
      HitRows around(caster_, fan_, hits_, parts_, world_from_sonar_, first, cols);
      std::vector<PatchTerms> terms(in_bins_.size());
      std::vector<char> changes(in_bins_.size(), 0);
      for (int row = 0; row < fan_.rows(); ++row, around.Advance()) {
        for (int col = first; col < first + cols; ++col) {
          if (!around.At(row, col).exists()) continue;
          const Hit hit = InColumn(around.At(row, col), row, col);
          if (!InWindow(hit.range_m)) continue;
          FillTerms(hit, around, row, col, terms, changes);
          const double depth_m = PatchDepthM(hit.range_m, fan_.RowHeightRad(row), hit.cosine);
          const auto spread = [&](double range_m, double over_m, const auto& add) {
            rows_.Spread(range_m, over_m, 1.0, [&](int at, double share) {
              for (std::size_t of = 0; of < fine.size(); ++of) {
                if (changes[of] != 0) add(fine[of].At(at, col - first), static_cast<float>(share), terms[of]);
              }
            });
          };
          spread(hit.range_m, depth_m,
                 [](FineTerms& to, float share, const PatchTerms& of) { to.Add(share, of.fine); });
          // Slope along range: spread once farther away, less once nearer, by half the depth each. Neighbours
          // then overlap, and their steps cancel.
          const double step_m = std::clamp(depth_m, least_step_m_, FineRows::kMaxParts * rows_.part_m);
          for (const double sign : {-1.0, 1.0}) {
            spread(hit.range_m + 0.5 * sign * step_m, step_m,
                   [per_m = static_cast<float>(sign / step_m)](FineTerms& to, float share,
                                                               const PatchTerms& of) {
                     to.level.Add(share * per_m, of.range);
                   });
          }
        }
      }
      for (std::size_t of = 0; of < fine.size(); ++of) ThroughPulse(fine[of], first, in_bins_[of]);
    });
    return std::move(in_bins_);
  }

 private:
  static PolarAxes Extended(PolarAxes axes, int bins) {
    const double by_m = bins * axes.range_bin_m();
    axes.range_min_m -= by_m;
    axes.range_max_m += by_m;
    axes.range_bins += 2 * bins;
    return axes;
  }

  bool InWindow(float range_m) const {
    return range_m > 0.0F && range_m >= traced_.range_min_m && range_m < traced_.range_max_m;
  }

  // The hit of the same plane in the middle of the column. Patches of a plane in one column then follow each
  // other without gaps, although the rows are staggered, and a plane that slides in itself changes nothing.
  Hit InColumn(Hit hit, int row, int col) const {
    if (!fan_.staggered()) return hit;
    constexpr float kMaxChange = 0.1F;  // of the inverse range
    const auto by_rad = static_cast<float>(fan_.AzimuthRad(col) - fan_.AzimuthRad(row, col));
    const Vector3f& u = hit.direction;
    const Vector3f middle(u.x() + by_rad * u.y(), u.y() - by_rad * u.x(), u.z());
    const float inverse_m = hit.InverseRangeAt(middle);
    if (!(std::abs(inverse_m - hit.inverse_m) < kMaxChange * hit.inverse_m)) return hit;
    hit.direction = middle;
    hit.cosine *= inverse_m / hit.inverse_m;
    hit.inverse_m = inverse_m;
    hit.range_m = 1.0F / inverse_m;
    return hit;
  }

  // Terms of a hit for moves of the sonar, then for those of each part. `changes`: which of them are not
  // zero.
  void FillTerms(const Hit& hit, const HitRows& around, int row, int col, std::vector<PatchTerms>& terms,
                 std::vector<char>& changes) const {
    const float half_tangent = std::sqrt(std::max(0.0F, 1.0F - hit.cosine) / (1.0F + hit.cosine));
    const PatchShader::Patch patch =
        shader_.Shade(row, col, caster_.TriangleMaterial(hit.triangle), hit.range_m, half_tangent);
    const Vector3f& u = hit.direction;
    const float cosine = std::max(std::hypot(u.x(), u.y()), 1e-6F);  // of elevation
    // Directions in which azimuth and elevation grow.
    const Vector3f right(u.y() / cosine, -u.x() / cosine, 0.0F);
    const Vector3f upward(-u.z() * u.x() / cosine, -u.z() * u.y() / cosine, cosine);
    // A move of a part by t and a turn by w move its point p by t + w x p.
    const Vector3f level_shift = -patch.by_cosine * hit.inverse_m * (hit.normal + hit.cosine * u) +
                                 patch.by_elevation * hit.inverse_m * upward -
                                 patch.power * (4.0F * hit.inverse_m + shader_.loss_per_m()) * u;
    const Vector3f level_turn = patch.by_elevation * right;
    const Vector3f azimuth_shift = (patch.power * hit.inverse_m / cosine) * right;
    const Vector3f azimuth_turn = -(patch.power / cosine) * upward;
    thread_local std::vector<Uncovered> uncovered;
    uncovered.assign(terms.size(), {});
    FindUncovered(around, row, col, right, upward, cosine, uncovered);
    const auto fill = [&](std::size_t of, float moves, float power) {
      const Uncovered& by_edges = uncovered[of];
      terms[of] = {.fine = {.level = {moves * level_shift + patch.power * by_edges.shift,
                                      moves * level_turn + patch.power * by_edges.turn, power, 0.0F},
                            .azimuth = {moves * azimuth_shift, moves * azimuth_turn, 0.0F, 0.0F}},
                   .range = {moves * patch.power * u, Vector3f::Zero(), 0.0F, power}};
    };
    changes[0] = 1;
    fill(0, -1.0F, patch.power);
    for (std::size_t of = 1; of < terms.size(); ++of) {
      const bool moves = hit.part + 1 == static_cast<int>(of);
      changes[of] = moves || !uncovered[of].shift.isZero(0.0F) || !uncovered[of].turn.isZero(0.0F) ? 1 : 0;
      if (changes[of] != 0) fill(of, moves ? 1.0F : 0.0F, 0.0F);
    }
  }

  // Shares that edges of nearer surfaces, edges of the fan and creases between parts uncover of a patch.
  void FindUncovered(const HitRows& around, int row, int col, const Vector3f& right, const Vector3f& upward,
                     float cosine, std::vector<Uncovered>& uncovered) const {
    const Hit& hit = around.At(row, col);
    const auto height = static_cast<float>(fan_.RowHeightRad(row));
    const float width = static_cast<float>(fan_.ColumnWidthRad(col)) * cosine;
    // `across`: from the neighbour to this patch. `turned`: across x direction.
    const auto edge = [&](int other_row, int other_col, const Vector3f& across, const Vector3f& turned,
                          float size) {
      if (other_row < 0 || other_row >= fan_.rows() || other_col < 0 || other_col >= fan_.cols()) {
        // The edge of the fan moves with the sonar, so that patches move across it.
        uncovered[0].Add(hit.inverse_m, -across, -turned, size);
        if (hit.part >= 0) uncovered[hit.part + 1].Add(hit.inverse_m, across, turned, size);
        return;
      }
      const Hit& other = around.At(other_row, other_col);
      if (!other.exists()) return;
      if (const float step = StepBetween(hit, other); step > 0.0F) {
        uncovered[0].Add(step, across, Vector3f::Zero(), size);
        if (hit.part >= 0) uncovered[hit.part + 1].Add(hit.inverse_m, across, turned, size);
        if (other.part >= 0) uncovered[other.part + 1].Add(other.inverse_m, -across, -turned, size);
        return;
      }
      if (hit.part == other.part) return;
      // A part that ends at the crease leaves a gap if it moves away, and no crease. The slope is the mean of
      // both sides of this kink.
      const auto add_crease = [&](int part, bool first) {
        if (part < 0) return;
        const Uncovered crease = MovedCrease(hit, other, size, first);
        if (crease.shift.isZero(0.0F) && crease.turn.isZero(0.0F)) return;
        const Hit& moved = first ? hit : other;
        const bool ends = EndsAtCrease(moved, first ? other : hit, caster_.scene(), world_from_sonar_);
        const float share = ends ? 0.5F : 1.0F;
        Uncovered& by_part = uncovered[part + 1];
        by_part.shift += share / size * crease.shift;
        by_part.turn += share / size * crease.turn;
        if (first) by_part.Add(hit.inverse_m, share * across, share * turned, size);
        if (!first && ends) by_part.Add(other.inverse_m, -0.5F * across, -0.5F * turned, size);
      };
      add_crease(hit.part, true);
      add_crease(other.part, false);
    };
    edge(row - 1, col, -upward, -right, height);
    edge(row + 1, col, upward, right, height);
    edge(row, col - 1, right, -upward, width);
    edge(row, col + 1, -right, upward, width);
  }

  void ThroughPulse(const FineMap& fine, int first, std::vector<BinTerms>& in_bins) const {
    for (int bin = 0; bin < axes_.range_bins; ++bin) {
      BinTerms* out = &in_bins[static_cast<std::size_t>(bin) * fan_.cols() + first];
      for (std::size_t k = 0; k < pulse_.weight.size(); ++k) {
        const int row = (bin + beyond_) * steps_ + pulse_.first + static_cast<int>(k);
        if (row < 0 || row >= rows_.count || fine.heard[row] == 0) continue;
        const auto weight = static_cast<float>(pulse_.weight[k]);
        const FineTerms* in = &fine.terms[static_cast<std::size_t>(row) * fine.cols];
        for (int col = 0; col < fine.cols; ++col) {
          out[col].by_response.Add(weight, in[col].level);
          out[col].by_slope.Add(weight, in[col].azimuth);
        }
      }
    }
  }

  const RayCaster& caster_;
  const RayFan& fan_;
  const PolarAxes& axes_;
  int steps_;
  ResponseWindow pulse_;
  int beyond_;        // range bins on either side of the axes
  PolarAxes traced_;  // with these, because patches beyond the axes move into them
  FineRows rows_;
  double least_step_m_;
  PatchShader shader_;
  FanHits hits_;
  SceneParts parts_;
  Pose world_from_sonar_;
  std::vector<std::vector<BinTerms>> in_bins_;  // of the sonar and of each part, per range bin and column
};

}  // namespace

EchoSlopes SlopesAlongMoves(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                            const AcousticGeometry& geometry, const ParameterSet& parameters,
                            const SceneParts& parts) {
  SONARCAL_CHECK(fan.sampling() == Sampling::kBeams, "slopes need rays per beam");
  SONARCAL_CHECK(parts.count == 0 || parts.of_triangle.size() == caster.scene().triangles.size(),
                 "{} triangles with parts, expected {}", parts.of_triangle.size(),
                 caster.scene().triangles.size());
  const PolarAxes& axes = geometry.sonar.axes;
  const EchoPowerModel model(geometry, parameters, caster.material_names());
  const std::vector<std::vector<BinTerms>> in_bins =
      SlopeGatherer(caster, fan, world_from_sonar, geometry, parameters, parts).Run();
  std::vector<double> column_azimuth_rad;
  for (int col = 0; col < fan.cols(); ++col) column_azimuth_rad.push_back(fan.AzimuthRad(col));
  const std::vector<ResponseWindow> response =
      AzimuthWindows(geometry.sonar, parameters, column_azimuth_rad, ResponseOf::kPower);
  const std::vector<ResponseWindow> slope =
      AzimuthWindows(geometry.sonar, parameters, column_azimuth_rad, ResponseOf::kPowerSlope);
  std::vector<SlopedWindow> azimuth;
  for (std::size_t beam = 0; beam < response.size(); ++beam)
    azimuth.emplace_back(response[beam], slope[beam]);
  const std::vector<double> gain = GainByBin(geometry, parameters);

  const auto empty = [&] {
    AlongMoves along;
    for (Grid<float>& of_move : along) of_move = Grid<float>(axes.range_bins, axes.beam_count());
    return along;
  };
  EchoSlopes slopes{.power = Grid<double>(axes.range_bins, axes.beam_count()),
                    .along = empty(),
                    .farther = Grid<float>(axes.range_bins, axes.beam_count()),
                    .of_part = std::vector<AlongMoves>(parts.count, empty())};
  tbb::parallel_for(0, axes.range_bins, [&](int bin) {
    const double level = gain[bin] * model.level();
    for (int beam = 0; beam < axes.beam_count(); ++beam) {
      const SlopedWindow& window = azimuth[beam];
      const auto sum_of = [&](std::size_t of) {
        const BinTerms* in = &in_bins[of][static_cast<std::size_t>(bin) * fan.cols() + window.first];
        Lanes sum;
        for (std::size_t k = 0; k < window.weight.size(); ++k) {
          sum.Add(window.weight[k], in[k].by_response);
          sum.Add(window.slopes[k], in[k].by_slope);
        }
        return sum;
      };
      const auto put = [&](const Lanes& sum, AlongMoves& along) {
        for (int move = 0; move < kSonarMoves; ++move)
          along[move](bin, beam) = static_cast<float>(level * sum.value[move]);
      };
      const Lanes of_sonar = sum_of(0);
      put(of_sonar, slopes.along);
      slopes.power(bin, beam) = level * of_sonar.value[kSonarMoves];
      slopes.farther(bin, beam) = static_cast<float>(level * of_sonar.value[kSonarMoves + 1]);
      for (int part = 0; part < parts.count; ++part) put(sum_of(part + 1), slopes.of_part[part]);
    }
  });
  return slopes;
}

}  // namespace sonarcal::sim
