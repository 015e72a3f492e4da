#include "sim/paper/paper_frame.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types/units.h"
#include "sim/paper/image_geometry.h"
#include "sim/physics/jitter.h"
#include "sim/rays/row_math/echoes.h"
#include "sim/rays/row_math/errors.h"

namespace sonarcal::sim {
namespace {

constexpr double kLargestStep = 0x1p30;

// Strength of a material over tan(incidence / 2), in units of full scale.
std::vector<float> StrengthTable(const GsabParameters<double>& gsab, double span_db, int steps) {
  std::vector<float> table;
  for (int i = 0; i <= steps + 1; ++i) {
    const double half_tangent = std::min(1.0, static_cast<double>(i) / steps);
    table.push_back(static_cast<float>(GsabDb(gsab, DegFromRad(2.0 * std::atan(half_tangent))) / span_db));
  }
  return table;
}

// Data shared by all rays of a frame.
class RowShader {
 public:
  RowShader(const RayFan& fan, const SonarModel& sonar, const PaperParameters<double>& parameters,
            double absorption_db_per_m, const PaperImageOptions& options)
      : fan_(fan), axes_(sonar.axes), seed_(options.noise_seed) {
    const double span_db = parameters.display.db_max - parameters.display.db_min;
    // Two-way loss is linear in ln R and R: spreading alone at ln R = 1, absorption alone at R = 1. The rest
    // of the sonar equation is the echo at 1 m without absorption and strength.
    level_.per_log = static_cast<float>(2.0 * TransmissionLossDb(std::numbers::e, 0.0) / span_db);
    level_.per_m = static_cast<float>(2.0 * TransmissionLossDb(1.0, absorption_db_per_m) / span_db);
    level_.offset = static_cast<float>(NormalisedPaperEcho(parameters, 0.0, 0.0));
    level_.limit = static_cast<float>(kLargestPaperEcho);
    double narrowest_deg = 90.0;
    for (const GsabParameters<double>& gsab : parameters.materials)
      narrowest_deg = std::min({narrowest_deg, gsab.b_deg, gsab.f_deg});
    constexpr double kStepsAWidth = 80.0;
    const int steps = static_cast<int>(std::clamp(kStepsAWidth * 90.0 / narrowest_deg, 1024.0, 65536.0));
    for (const GsabParameters<double>& gsab : parameters.materials)
      strengths_.push_back(StrengthTable(gsab, span_db, steps));
    table_steps_ = steps;

    const int min_rays = *std::min_element(fan.rays_per_beam().begin(), fan.rays_per_beam().end());
    steps_of_one_ = kLargestStep / kLargestPaperEcho * std::max(1, min_rays) / fan.largest_weight();
    for (int col = 0; col < fan.cols(); ++col) {
      const int beam = fan.BeamOfColumn(col);
      beam_.push_back(beam);
      azimuth_rad_.push_back(static_cast<float>(fan.AzimuthRad(col)));
      weight_.push_back(static_cast<float>(steps_of_one_ / fan.rays_per_beam()[beam]));
    }
    if (!seed_) return;
    const JitterParameters<double>& jitter = parameters.jitter;
    growth_ = {.per_reference_square =
                   static_cast<float>(1.0 / (jitter.reference_range_m * jitter.reference_range_m)),
               .root = jitter.growth == JitterGrowth::kRoot};
    range_scale_ = static_cast<float>(JitterSigmaRangeM(jitter, 0.0, sonar.frequency_hz));
    azimuth_scale_ = static_cast<float>(JitterSigmaAzimuthRad(jitter, 0.0, sonar.frequency_hz));
    even_beams_ = ImageGeometry(sonar, absorption_db_per_m).beams_are_even;
  }

  double steps_of_one() const { return steps_of_one_; }

  // Arrays for the hits of a row, one set per thread.
  struct Buffers {
    explicit Buffers(int cols)
        : weight(cols),
          true_azimuth_rad(cols),
          range_m(cols),
          azimuth_rad(cols),
          of_columns(cols),
          a(cols),
          b(cols),
          steps(cols),
          bin(cols),
          beam(cols),
          pixel(cols) {}
    std::vector<float> weight;
    std::vector<float> true_azimuth_rad;
    std::vector<float> range_m;
    std::vector<float> azimuth_rad;
    std::vector<float> of_columns;
    std::vector<float> a;
    std::vector<float> b;
    std::vector<std::int32_t> steps;
    std::vector<std::int32_t> bin;
    std::vector<std::int32_t> beam;
    std::vector<std::int32_t> pixel;
  };

  // Adds hits to `sums`: one sum per pixel, beams fastest, then one for all rays outside the image.
  void Add(const RowHits& hits, Buffers& of, std::vector<std::int64_t>& sums) const {
    Shade(hits, of);
    const float* range_m = hits.range_m;
    if (seed_) {
      const auto first = static_cast<std::uint32_t>(hits.row) * static_cast<std::uint32_t>(fan_.cols());
      row_math::NormalPairs(*seed_, first, hits.col, hits.count, of.a.data(), of.b.data());
      const float* azimuth_rad = azimuth_rad_.data();
      if (fan_.staggered()) {
        fan_.RowAzimuths(hits.row, of.true_azimuth_rad.data());
        azimuth_rad = of.true_azimuth_rad.data();
      }
      row_math::Disturb(growth_, range_scale_, azimuth_scale_, hits.range_m,
                        OfHits(azimuth_rad, hits, of.of_columns), of.a.data(), of.b.data(), hits.count,
                        of.range_m.data(), of.azimuth_rad.data());
      range_m = of.range_m.data();
      BeamsOf(hits.count, of);
    } else {
      for (int i = 0; i < hits.count; ++i) of.beam[i] = beam_[hits.col[i]];
    }
    row_math::Bins(range_m, static_cast<float>(axes_.range_min_m),
                   static_cast<float>(1.0 / axes_.range_bin_m()), axes_.range_bins, hits.count,
                   of.bin.data());
    row_math::Pixels(hits.range_m, static_cast<float>(axes_.range_min_m),
                     static_cast<float>(axes_.range_max_m), of.bin.data(), of.beam.data(), axes_.beam_count(),
                     static_cast<std::int32_t>(sums.size() - 1), hits.count, of.pixel.data());
    for (int i = 0; i < hits.count; ++i) sums[of.pixel[i]] += of.steps[i];
  }

 private:
  // Selects the hits from an array with one number per column. Returns the array itself if every ray hit.
  const float* OfHits(const float* of_columns, const RowHits& hits, std::vector<float>& buffer) const {
    if (hits.count == fan_.cols()) return of_columns;
    for (int i = 0; i < hits.count; ++i) buffer[i] = of_columns[hits.col[i]];
    return buffer.data();
  }

  void Shade(const RowHits& hits, Buffers& of) const {
    const float* weight = weight_.data();
    if (!fan_.weighs_evenly()) {
      fan_.RowWeights(hits.row, of.weight.data());
      for (int i = 0; i < fan_.cols(); ++i) of.weight[i] *= weight_[i];
      weight = of.weight.data();
    }
    weight = OfHits(weight, hits, of.of_columns);
    ForEachMaterial(hits, [&](int first, int count) {
      const row_math::Table table{strengths_[hits.material[first]].data(), table_steps_};
      row_math::EchoSteps(level_, table, hits.range_m + first, hits.half_tangent + first, weight + first,
                          count, of.steps.data() + first);
    });
  }

  void BeamsOf(int count, Buffers& of) const {
    const int beams = axes_.beam_count();
    if (even_beams_) {
      row_math::Bins(of.azimuth_rad.data(), static_cast<float>(axes_.BeamEdgeRad(0)),
                     static_cast<float>(1.0 / (axes_.field_of_view_rad() / beams)), beams, count,
                     of.beam.data());
      return;
    }
    for (int i = 0; i < count; ++i) {
      const int beam = axes_.BeamAt(of.azimuth_rad[i]);
      of.beam[i] = beam < beams ? beam : -1;
    }
  }

  const RayFan& fan_;
  const PolarAxes& axes_;
  std::optional<std::uint64_t> seed_;
  row_math::EchoLevel level_;
  std::vector<std::vector<float>> strengths_;  // per material
  int table_steps_ = 0;
  double steps_of_one_ = 0.0;  // fixed-point value of a ray that is a pixel's whole echo
  std::vector<std::int32_t> beam_;
  std::vector<float> azimuth_rad_;
  std::vector<float> weight_;
  row_math::Growth growth_;
  float range_scale_ = 0.0F;
  float azimuth_scale_ = 0.0F;
  bool even_beams_ = true;
};

}  // namespace

PolarImage RenderPaperFrame(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
                            const SonarModel& sonar, const PaperParameters<double>& parameters,
                            double absorption_db_per_m, const PaperImageOptions& options) {
  SONARCAL_CHECK(parameters.materials.size() == caster.material_names().size(),
                 "{} materials, {} parameter sets", caster.material_names().size(),
                 parameters.materials.size());
  const PolarAxes& axes = sonar.axes;
  const RowShader shader(fan, sonar, parameters, absorption_db_per_m, options);
  struct Local {
    std::vector<std::int64_t> sums;
    RowShader::Buffers buffers;
  };
  tbb::enumerable_thread_specific<Local> locals([&] {
    const std::size_t pixels = static_cast<std::size_t>(axes.range_bins) * axes.beam_count();
    return Local{std::vector<std::int64_t>(pixels + 1), RowShader::Buffers(fan.cols())};
  });
  caster.CastRows(fan, world_from_sonar, axes.range_max_m, [&](const RowHits& hits) {
    Local& local = locals.local();
    shader.Add(hits, local.buffers, local.sums);
  });

  Grid<std::int64_t> total(axes.range_bins, axes.beam_count());
  for (const Local& local : locals) {
    for (std::size_t i = 0; i < total.size(); ++i) total.values()[i] += local.sums[i];
  }
  return PaperImageOfSums(total, shader.steps_of_one(), axes, parameters.display, options.full_scale);
}

}  // namespace sonarcal::sim
