#include "calib/models/blocked_frames.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"

namespace sonarcal::calib {
namespace {

AcousticFrame InBlocks(const AcousticFrame& fine, const PolarAxes& axes, const PolarAxes& coarse,
                       const PixelBlock& block) {
  AcousticFrame blocked{
      .index = fine.index, .world_from_sonar = fine.world_from_sonar, .recorded = {}, .use = {}};
  for (int row = 0; row < coarse.range_bins; ++row) {
    for (int col = 0; col < coarse.beam_count(); ++col) {
      double power = 0.0;
      int counted = 0;
      int censored = 0;
      Censoring kind = Censoring::kNone;
      for (int bin = row * block.bins; bin < std::min((row + 1) * block.bins, axes.range_bins); ++bin) {
        for (int beam = col * block.beams; beam < std::min((col + 1) * block.beams, axes.beam_count());
             ++beam) {
          const std::size_t pixel = static_cast<std::size_t>(bin) * axes.beam_count() + beam;
          if (!fine.use.empty() && fine.use[pixel] == 0) continue;
          const RecordedPower& of = fine.recorded[pixel];
          power += of.power;
          ++counted;
          if (of.censoring == Censoring::kNone) continue;
          ++censored;
          kind = of.censoring;
        }
      }
      // A block is censored if most of it is.
      blocked.recorded.push_back(
          {counted > 0 ? power / counted : 0.0, 2 * censored > counted ? kind : Censoring::kNone});
      blocked.use.push_back(counted > 0 ? 1 : 0);
    }
  }
  return blocked;
}

// Integral of the response of a beam table, in units of its offsets.
double EquivalentWidth(const std::vector<double>& table_db) {
  const sim::AzimuthShape<double> shape{
      .pattern = AzimuthPattern::kTable, .table_db = &table_db, .beam_spacing_rad = 1.0};
  return sim::AzimuthEquivalentWidthRad(sim::AzimuthResponse<double>(shape), 0.0);
}

// Beam table by offsets in blocks: that of the beams, widened by a Gaussian of one block, so that no echo is
// lost between two blocks. Its factor keeps the level of extended surfaces.
std::vector<double> CoarseTable(const std::vector<double>& fine_db, int beams_at_once) {
  const int reach = static_cast<int>(fine_db.size()) / 2;  // beams
  const int blocks = (reach + beams_at_once - 1) / beams_at_once + 1;
  std::vector<double> coarse_db;
  for (int block = -blocks; block <= blocks; ++block) {
    double power = 0.0;
    for (int beam = -reach; beam <= reach; ++beam) {
      const double off_blocks = static_cast<double>(beam) / beams_at_once - block;
      power += sim::GaussianResponse(off_blocks, 1.0) * PowerFromDb(fine_db[beam + reach]);
    }
    coarse_db.push_back(DbFromPower(power));
  }
  const double factor_db =
      DbFromPower(EquivalentWidth(fine_db) / (beams_at_once * EquivalentWidth(coarse_db)));
  for (double& level_db : coarse_db) level_db += factor_db;
  return coarse_db;
}

}  // namespace

PixelBlock BlockOfHalfACell(const SonarModel& sonar, const ParameterSet& parameters) {
  constexpr double kOfCell = 0.7;  // of each width, so half of the area
  const double spacing_deg = DegFromRad(sonar.axes.beam_spacing_rad());
  const double width_deg = parameters.beam.azimuth_width_deg > 0.0 ? parameters.beam.azimuth_width_deg
                                                                   : sonar.azimuth_beam_width_deg;
  const auto pixels = [](double cell) { return std::max(1, static_cast<int>(std::lround(kOfCell * cell))); };
  return {.bins = pixels(parameters.pulse.length_m / sonar.axes.range_bin_m()),
          .beams = spacing_deg > 0.0 ? pixels(width_deg / spacing_deg) : 1};
}

BlockedFrames InBlocks(const SonarModel& sonar, const ParameterSet& parameters,
                       const std::vector<AcousticFrame>& frames, const PixelBlock& block) {
  BlockedFrames blocked{.sonar = sonar, .parameters = parameters, .frames = {}};
  blocked.sonar.axes = CoarseAxes(sonar.axes, block);
  ReceiverParameters& receiver = blocked.parameters.receiver;
  for (std::vector<double>* per_beam : {&receiver.noise_taper_db, &receiver.noise_after_gain_taper_db,
                                        &blocked.parameters.beam.sensitivity_db})
    *per_beam = CoarseTaper(*per_beam, block.beams);
  if (parameters.beam.azimuth_pattern == AzimuthPattern::kTable && block.beams > 1) {
    const sim::AzimuthShape<double> shape = sim::AzimuthShapeOf(sonar, parameters);  // checks the table
    blocked.parameters.beam.azimuth_table_db = CoarseTable(*shape.table_db, block.beams);
  }
  for (const AcousticFrame& frame : frames)
    blocked.frames.push_back(InBlocks(frame, sonar.axes, blocked.sonar.axes, block));
  return blocked;
}

}  // namespace sonarcal::calib
