#include "sim/ghosts/ghost_math.h"

#include <cmath>
#include <limits>

#include "core/math/vector_versions.h"
#include "sim/physics/patch.h"

namespace sonarcal::sim::ghost_math {

SONARCAL_VECTOR_VERSIONS
void Powers(const Echoes& echoes, float loss_per_m, int count, float* __restrict power) {
  constexpr auto kSmallest = static_cast<float>(kSmallestCosine);
  constexpr auto kGrazing = static_cast<float>(std::numeric_limits<double>::epsilon());
  float cosine[Echoes::kMax];
  float slow[Echoes::kMax];
  // Separate loops, because the compiler does not vectorise a loop that calls several of these functions.
  for (int i = 0; i < count; ++i) cosine[i] = std::cos(echoes.incidence_rad[i]);
  for (int i = 0; i < count; ++i) slow[i] = cosine[i] * std::cos(echoes.other_incidence_rad[i]);
  for (int i = 0; i < count; ++i) {
    const float kept = slow[i] > kGrazing ? slow[i] : kGrazing;
    const float raised = echoes.c[i] * std::exp(echoes.half_d[i] * std::log(kept));
    slow[i] = slow[i] > kGrazing ? raised : 0.0F;
  }
  for (int i = 0; i < count; ++i) {
    const float square = echoes.tilt_rad[i] * echoes.tilt_rad[i];
    const float backscatter = slow[i] + echoes.a[i] * std::exp(-square * echoes.per_b[i]) +
                              echoes.e[i] * std::exp(-square * echoes.per_f[i]);
    const float area_cosine = cosine[i] > kSmallest ? cosine[i] : kSmallest;
    // The patch grows with the square of the spreading out, which that leg loses.
    const float back = echoes.back_spreading_m[i] * echoes.back_spreading_m[i];
    power[i] = echoes.weight[i] * std::sqrt(echoes.elevation_power[i]) * backscatter *
               std::exp(-loss_per_m * echoes.length_m[i]) / (back * area_cosine);
  }
}

}  // namespace sonarcal::sim::ghost_math
