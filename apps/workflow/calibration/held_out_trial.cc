#include "apps/workflow/calibration/held_out_trial.h"

#include <algorithm>

#include "apps/workflow/fit_frames.h"
#include "calib/models/blocked_frames.h"
#include "core/types/error.h"
#include "data_io/pose_io.h"

namespace sonarcal::workflow {

std::vector<calib::GreyFrame> GreyFrames(const RecordingSource& recording, const std::vector<int>& indices) {
  return GreyFrames(recording, data_io::PosesOfRecording(recording), indices);
}

void StartAt(const calib::FitReport& found, calib::FitConfig& config) {
  for (const calib::FittedParameter& parameter : found.parameters) {
    if (parameter.status != calib::ParameterStatus::kFixed) config.start[parameter.name] = parameter.value;
  }
}

Trial HeldOutTrials::Try(const ParameterSet& parameters, calib::FitConfig config, calib::FitOptions options) {
  if (options.starts > 1) {
    calib::FitOptions search = options;
    search.standard_errors = false;
    StartAt(Search(parameters, config, search).report, config);
    options.starts = 1;
    options.search_level = false;
    options.near_start = true;
  }
  Trial trial;
  const std::vector<calib::AcousticFrame> frames = calib::FramesFor(used_, parameters.display);
  trial.fit = calib::FitAcousticModel(simulator_, frames, parameters, config, options);
  if (!trial.fit.usable) {
    throw DataError(
        "calibrate: the fit to frames has no usable solution ({})",
        trial.fit.report.termination.empty() ? "the frames determine nothing" : trial.fit.report.termination);
  }
  if (held_out_.empty()) return trial;
  std::vector<calib::AcousticFrame> judged = calib::FramesFor(held_out_, parameters.display);
  for (calib::AcousticFrame& frame : judged)
    frame.world_from_sonar = frame.world_from_sonar * trial.fit.mount;
  if (std::ranges::find(*config.free, "pose") != config.free->end()) {
    const std::vector<Pose> poses = calib::FitPosesOnly(*trial.fit.simulator, judged, trial.fit.parameters,
                                                        config.pose_prior, options.progress);
    for (std::size_t i = 0; i < judged.size(); ++i) judged[i].world_from_sonar = poses[i];
  }
  for (const calib::AcousticFrame& frame : judged) trial.held_out_poses.push_back(frame.world_from_sonar);
  const calib::AcousticFrameModel model(*trial.fit.simulator, judged, trial.fit.parameters);
  if (!block_) block_ = calib::BlockSize(model, options);
  trial.likelihood = calib::GreyLikelihood(held_out_, calib::MeanPowers(model), trial.fit.parameters,
                                           block_->bins, block_->beams);
  trial.likelihood.variance_factor = block_->variance_factor;
  return trial;
}

calib::AcousticFit HeldOutTrials::Search(const ParameterSet& parameters, const calib::FitConfig& config,
                                         const calib::FitOptions& options) const {
  const SonarModel& sonar = simulator_.sonar();
  calib::BlockedFrames blocked =
      calib::InBlocks(sonar, parameters, calib::FramesFor(used_, parameters.display),
                      calib::BlockOfHalfACell(sonar, parameters));
  sim::SimulationOptions simulation = simulator_.options();
  simulation.fan.cols = std::max(simulation.fan.cols / 2, 2 * blocked.sonar.axes.beam_count());
  const sim::Simulator simulator(simulator_.shared_caster(), blocked.sonar, simulation);
  calib::AcousticFit fit =
      calib::FitAcousticModel(simulator, blocked.frames, blocked.parameters, config, options);
  if (!fit.usable) throw DataError("calibrate: the search of the placement has no usable solution");
  fit.simulator.reset();  // refers to the local one
  return fit;
}

calib::LikelihoodDifference HeldOutTrials::Gain(const Trial& a, const Trial& b) {
  if (a.likelihood.nats.empty()) return {};
  return calib::Difference(a.likelihood, b.likelihood);
}

bool IsSignificant(const calib::LikelihoodDifference& gain) {
  constexpr double kSigmas = 2.0;
  return gain.mean > kSigmas * gain.sigma && gain.mean > 0.0;
}

}  // namespace sonarcal::workflow
