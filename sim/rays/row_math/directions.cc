#include "sim/rays/row_math/directions.h"

#include <cmath>
#include <numbers>

#include "core/math/vector_versions.h"

namespace sonarcal::sim::row_math {

namespace {

// Angle of a sine and a cosine that are not negative. The quotient of the smaller by the larger one keeps the
// digits at both ends.
__attribute__((always_inline)) inline float AngleOf(float sine, float cosine) {
  const bool steep = sine > cosine;
  const float small = steep ? cosine : sine;
  const float large = steep ? sine : cosine;
  const float angle = std::atan(small / (large + 1e-30F));
  return steep ? 0.5F * std::numbers::pi_v<float> - angle : angle;
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void Angles(const float* __restrict sine, const float* __restrict cosine, int count,
            float* __restrict angle_rad) {
  for (int i = 0; i < count; ++i) angle_rad[i] = AngleOf(sine[i], cosine[i]);
}

SONARCAL_VECTOR_VERSIONS
void Bearings(const float* __restrict x, const float* __restrict y, const float* __restrict z, int count,
              float* __restrict azimuth_rad, float* __restrict elevation_rad) {
  for (int i = 0; i < count; ++i) {
    const float aside = AngleOf(std::abs(x[i]), std::abs(y[i]));
    azimuth_rad[i] = std::copysign(y[i] < 0.0F ? std::numbers::pi_v<float> - aside : aside, x[i]);
  }
  for (int i = 0; i < count; ++i) {
    const float raised = AngleOf(std::abs(z[i]), std::sqrt(x[i] * x[i] + y[i] * y[i]));
    elevation_rad[i] = std::copysign(raised, z[i]);
  }
}

SONARCAL_VECTOR_VERSIONS
void Directions(const float* __restrict x, const float* __restrict y, float across, float up,
                const float* __restrict rotation, int count, float* __restrict world_x,
                float* __restrict world_y, float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const float right = x[i] * across;
    const float ahead = y[i] * across;
    const float scale = 1.0F / std::sqrt(right * right + ahead * ahead + up * up);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * up);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * up);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * up);
  }
}

namespace {

// Sine and cosine of an angle by the first terms of their series, exact to single precision: all terms within
// half a radian, two terms of each within kNarrowRad.
enum class Terms { kAll, kTwo };
constexpr float kNarrowRad = 0.02F;

template <Terms kTerms>
struct SmallTurn {
  explicit SmallTurn(float angle_rad) {
    const float square = angle_rad * angle_rad;
    // Factors rather than quotients, because the compiler may not turn a division into a multiplication.
    if constexpr (kTerms == Terms::kTwo) {
      sine = angle_rad * (1.0F - square * (1.0F / 6.0F));
      cosine = 1.0F - square * 0.5F;
    } else {
      sine = angle_rad * (1.0F - square * (1.0F / 6.0F) *
                                     (1.0F - square * (1.0F / 20.0F) * (1.0F - square * (1.0F / 42.0F))));
      cosine = 1.0F - square * 0.5F * (1.0F - square * (1.0F / 12.0F) * (1.0F - square * (1.0F / 30.0F)));
    }
  }
  float sine;
  float cosine;
};

// Factor that gives a vector the length 1. Its squared length is already 1 up to rounding, so one step of
// Newton's method for the inverse of the square root suffices.
__attribute__((always_inline)) inline float ToUnit(float squared_length) {
  return 1.5F - 0.5F * squared_length;
}

template <Terms kTerms>
__attribute__((always_inline)) inline void TurnAndRaise(const float* __restrict x, const float* __restrict y,
                                                        const float* __restrict width_rad, float part,
                                                        const float* __restrict elevation_offset,
                                                        float height_rad, float across, float up,
                                                        const float* __restrict rotation, int count,
                                                        float* __restrict world_x, float* __restrict world_y,
                                                        float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const SmallTurn<kTerms> aside(part * width_rad[i]);
    const SmallTurn<kTerms> raised(elevation_offset[i] * height_rad);
    const float level = across * raised.cosine - up * raised.sine;
    const float height = up * raised.cosine + across * raised.sine;
    const float right = (x[i] * aside.cosine + y[i] * aside.sine) * level;
    const float ahead = (y[i] * aside.cosine - x[i] * aside.sine) * level;
    const float scale = ToUnit(right * right + ahead * ahead + height * height);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * height);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * height);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * height);
  }
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void TurnedAndRaisedDirections(const float* x, const float* y, const float* width_rad, float part,
                               const float* elevation_offset, float height_rad, float across, float up,
                               const float* rotation, int count, float* world_x, float* world_y,
                               float* world_z) {
  int wide = std::abs(height_rad) < kNarrowRad ? 0 : 1;
  for (int i = 0; i < count; ++i) wide += std::abs(part * width_rad[i]) < kNarrowRad ? 0 : 1;
  if (wide == 0) {
    TurnAndRaise<Terms::kTwo>(x, y, width_rad, part, elevation_offset, height_rad, across, up, rotation,
                              count, world_x, world_y, world_z);
  } else {
    TurnAndRaise<Terms::kAll>(x, y, width_rad, part, elevation_offset, height_rad, across, up, rotation,
                              count, world_x, world_y, world_z);
  }
}

SONARCAL_VECTOR_VERSIONS
void TurnedDirections(const float* __restrict x, const float* __restrict y, const float* __restrict width_rad,
                      float part, float across, float up, const float* __restrict rotation, int count,
                      float* __restrict world_x, float* __restrict world_y, float* __restrict world_z) {
  for (int i = 0; i < count; ++i) {
    const SmallTurn<Terms::kAll> aside(part * width_rad[i]);
    const float right = (x[i] * aside.cosine + y[i] * aside.sine) * across;
    const float ahead = (y[i] * aside.cosine - x[i] * aside.sine) * across;
    const float scale = ToUnit(right * right + ahead * ahead + up * up);
    world_x[i] = scale * (rotation[0] * right + rotation[1] * ahead + rotation[2] * up);
    world_y[i] = scale * (rotation[3] * right + rotation[4] * ahead + rotation[5] * up);
    world_z[i] = scale * (rotation[6] * right + rotation[7] * ahead + rotation[8] * up);
  }
}

SONARCAL_VECTOR_VERSIONS
void CellWeights(const float* __restrict cosine, const float* __restrict limit,
                 const float* __restrict per_rad, float slope, float height, int count,
                 float* __restrict weight) {
  const float upper = slope + 0.5F * height;
  const float lower = slope - 0.5F * height;
  for (int i = 0; i < count; ++i) {
    const float top = upper < limit[i] ? upper : limit[i];
    const float bottom = lower > -limit[i] ? lower : -limit[i];
    // The height minus the parts beyond the limits keeps the digits that top - bottom would lose.
    const float within = height - (upper - top) - (bottom - lower);
    const float kept = within > 0.0F ? within : 0.0F;
    const float near = cosine[i];
    // An elevation is atan(slope x cosine). The difference of two is the arctangent of (a - b) / (1 + a b).
    const float beside = 1.0F + top * bottom * near * near;
    const float turned = beside < 0.0F ? std::numbers::pi_v<float> : 0.0F;
    weight[i] = per_rad[i] * (std::atan(kept * near / beside) + turned);
  }
}

SONARCAL_VECTOR_VERSIONS
void HalfTangents(const float* __restrict dx, const float* __restrict dy, const float* __restrict dz,
                  const float* __restrict nx, const float* __restrict ny, const float* __restrict nz,
                  int count, float* __restrict half_tangent) {
  for (int i = 0; i < count; ++i) {
    const float x = dy[i] * nz[i] - dz[i] * ny[i];
    const float y = dz[i] * nx[i] - dx[i] * nz[i];
    const float z = dx[i] * ny[i] - dy[i] * nx[i];
    const float sine_square = x * x + y * y + z * z;
    const float cosine = std::abs(dx[i] * nx[i] + dy[i] * ny[i] + dz[i] * nz[i]);
    const float length = std::sqrt(sine_square + cosine * cosine);
    half_tangent[i] = std::sqrt(sine_square) / (length + cosine + 1e-30F);
  }
}

namespace {

__attribute__((always_inline)) inline float RangeTo(const Plane& plane, const Rays& rays, int i) {
  const double towards =
      plane[0] * rays.direction[0][i] + plane[1] * rays.direction[1][i] + plane[2] * rays.direction[2][i];
  const double away = plane[3] - (plane[0] * rays.origin_m[0][i] + plane[1] * rays.origin_m[1][i] +
                                  plane[2] * rays.origin_m[2][i]);
  const double range_m = away / towards;
  const double farthest_m = rays.farthest_m[i];
  const double limited_m = range_m < farthest_m ? range_m : farthest_m;  // NaN becomes the farthest
  return static_cast<float>(limited_m > 0.0 ? limited_m : 0.0);
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void PlaneRanges(const Plane* __restrict planes, const std::uint32_t* __restrict plane, const Rays& rays,
                 int count, float* __restrict range_m) {
  int others = 0;
  for (int i = 0; i < count; ++i) others += plane[i] != plane[0] ? 1 : 0;
  if (others == 0) {
    // Most neighbouring rays meet one plane. Vector instructions then need not gather planes.
    const Plane& only = planes[plane[0]];
    for (int i = 0; i < count; ++i) range_m[i] = RangeTo(only, rays, i);
  } else {
    for (int i = 0; i < count; ++i) range_m[i] = RangeTo(planes[plane[i]], rays, i);
  }
}

}  // namespace sonarcal::sim::row_math
