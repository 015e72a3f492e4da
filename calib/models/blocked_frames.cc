#include "calib/models/blocked_frames.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"

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
  for (const AcousticFrame& frame : frames)
    blocked.frames.push_back(InBlocks(frame, sonar.axes, blocked.sonar.axes, block));
  return blocked;
}

}  // namespace sonarcal::calib
