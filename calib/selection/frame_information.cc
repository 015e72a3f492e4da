#include "calib/selection/frame_information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "calib/models/acoustic_frame_model.h"
#include "calib/models/blocked_frames.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

// Number of frames traced at once, which bounds the memory.
constexpr std::size_t kFramesAtOnce = 16;

// Share of the expected pixels that are assumed to hold noise alone.
constexpr double kDarkest = 0.2;

// Number of poses at which the noise level is estimated.
constexpr std::size_t kPosesForNoise = 8;

// No power is clipped by this display, and none underflows.
constexpr DisplayParameters<double> kUnclipped = {.db_min = -600.0, .db_max = 600.0};
constexpr double kNoNoiseDb = -200.0;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

bool IsMount(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kPose && entry.frame == kMountFrame;
}

// Curves and noise level first, then geometry, then the six components of the common pose error.
std::vector<int> ParametersOf(const std::vector<CatalogEntry>& catalog,
                              const FrameInformationOptions& options) {
  const auto stage = [&](const CatalogEntry& entry) {
    if (entry.group == ParameterGroup::kGsab || entry.name == "receiver.noise_db") return 0;
    const bool axes = entry.name.ends_with("_offset_m") || entry.name.ends_with("_offset_deg") ||
                      entry.name.ends_with("_scale");
    if (options.geometry && entry.group == ParameterGroup::kGeometry && axes) return 1;
    return options.poses && IsMount(entry) ? 2 : 3;
  };
  std::vector<int> chosen;
  for (int wanted = 0; wanted < 3; ++wanted) {
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      if (stage(catalog[i]) == wanted) chosen.push_back(static_cast<int>(i));
    }
  }
  return chosen;
}

double PriorSigma(const CatalogEntry& entry, const PosePrior& of_poses) {
  if (IsMount(entry)) return entry.index < 3 ? of_poses.position_m : of_poses.angle_deg;
  return entry.StepSigma();
}

// Information that a frame adds to `before` others from its pose: what n frames have together is
// n / (1 + (n - 1) rho) times that of one (AcousticFrameModel::ShareRepeats).
double ShareOfRepeat(double rho, int before) {
  if (before == 0) return 1.0;
  return (1.0 - rho) / ((1.0 + before * rho) * (1.0 + (before - 1) * rho));
}

// Removes the error that a pose has of its own, whose prior is the unit matrix.
Eigen::MatrixXd WithoutOwnPose(const Eigen::MatrixXd& information) {
  const Eigen::MatrixXd across = information.rightCols(kPoseSteps);
  const Eigen::MatrixXd own = information.bottomRightCorner(kPoseSteps, kPoseSteps) +
                              Eigen::MatrixXd::Identity(kPoseSteps, kPoseSteps);
  return information - across * own.llt().solve(across.transpose());
}

}  // namespace

FrameInformation::FrameInformation(const sim::Simulator& simulator, const ParameterSet& parameters,
                                   std::vector<Pose> poses, const FrameInformationOptions& options)
    : poses_(std::move(poses)), options_(options) {
  const PolarAxes& fine = simulator.sonar().axes;
  const PixelBlock block{.bins = (fine.range_bins + options.max_bins - 1) / options.max_bins,
                         .beams = (fine.beam_count() + options.max_beams - 1) / options.max_beams};
  ParameterSet complete = sim::WithResponse(simulator.sonar(), parameters);
  complete.model = EchoModel::kAcoustic;
  complete.mirrors.clear();
  complete.display = kUnclipped;
  const double cell_bins = std::max(1.0, complete.pulse.length_m / fine.range_bin_m());
  const double spacing_deg = DegFromRad(fine.beam_spacing_rad());
  const double cell_beams =
      spacing_deg > 0.0 ? std::max(1.0, complete.beam.azimuth_width_deg / spacing_deg) : 1.0;
  cells_per_pixel_ = block.bins * block.beams / (cell_bins * cell_beams);
  BlockedFrames blocked = InBlocks(simulator.sonar(), complete, {}, block);
  parameters_ = std::move(blocked.parameters);
  // Echoes between the centres of two pixels must not be lost.
  const PolarAxes& axes = blocked.sonar.axes;
  parameters_.pulse.length_m = std::max(parameters_.pulse.length_m, axes.range_bin_m());
  if (axes.beam_count() > 1) {
    parameters_.beam.azimuth_width_deg =
        std::max(parameters_.beam.azimuth_width_deg, DegFromRad(axes.beam_spacing_rad()));
  }
  sim::SimulationOptions rays = simulator.options();
  rays.fan.cols = std::min(rays.fan.cols, 2 * axes.beam_count());
  rays.fan.rows = std::min(rays.fan.rows, options.max_rows);
  coarse_.emplace(simulator.shared_caster(), blocked.sonar, rays);
  if (!parameters_.receiver.noise_db) parameters_.receiver.noise_db = NoiseOfDarkest();
  const std::vector<AcousticFrame> none;
  const AcousticFrameModel model(*coarse_, none, parameters_);
  for (const int index : ParametersOf(model.catalog(), options_))
    names_.push_back(model.catalog()[index].name);
}

AcousticFrame FrameInformation::FrameAt(int pose) const {
  const PolarAxes& axes = coarse_->sonar().axes;
  const std::size_t pixels = static_cast<std::size_t>(axes.range_bins) * axes.beam_count();
  return {.index = pose,
          .world_from_sonar = poses_[pose],
          .recorded = std::vector<RecordedPower>(pixels, {1.0, Censoring::kNone})};
}

double FrameInformation::NoiseOfDarkest() const {
  ParameterSet without = parameters_;
  without.receiver.noise_db = kNoNoiseDb;
  std::vector<AcousticFrame> frames;
  const std::size_t step = std::max<std::size_t>(1, poses_.size() / kPosesForNoise);
  for (std::size_t i = 0; i < poses_.size(); i += step) frames.push_back(FrameAt(static_cast<int>(i)));
  const AcousticFrameModel model(*coarse_, frames, without);
  std::vector<double> echoes;
  for (int frame = 0; frame < model.frame_count(); ++frame) {
    for (const double power : model.MeanPower(frame, model.initial_values())) {
      if (power > 10.0 * PowerFromDb(kNoNoiseDb)) echoes.push_back(power);
    }
  }
  if (echoes.empty()) return 0.0;
  const auto darkest =
      echoes.begin() + static_cast<std::ptrdiff_t>(kDarkest * static_cast<double>(echoes.size() - 1));
  std::nth_element(echoes.begin(), darkest, echoes.end());
  return DbFromPower(*darkest);
}

Eigen::MatrixXd FrameInformation::OfFrame(const AcousticFrameModel& model, int frame,
                                          const std::vector<int>& active, int before) const {
  const std::vector<CatalogEntry>& catalog = model.catalog();
  const ParameterValues& values = model.initial_values();
  PixelTerms terms;
  if (!model.Evaluate(frame, values, active, FrameModel::Terms::kDerivatives, terms))
    throw DataError("frame {}: the start parameters expect no positive power", model.frame_index(frame));
  const auto pixels = static_cast<Eigen::Index>(model.pixel_count());
  const auto count = static_cast<Eigen::Index>(active.size());
  Eigen::VectorXd scale(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const CatalogEntry& entry = catalog[active[k]];
    scale(k) = entry.ValueSlope(values[active[k]]) * PriorSigma(entry, options_.pose_prior);
  }
  const sim::ReceiverNoise noise(parameters_.receiver, coarse_->sonar().axes, coarse_->absorption_db_per_m());
  const std::vector<double> mean = model.MeanPower(frame, values);
  Eigen::VectorXd weight(pixels);
  for (Eigen::Index pixel = 0; pixel < pixels; ++pixel) {
    const int bin = static_cast<int>(pixel) / model.beams();
    const int beam = static_cast<int>(pixel) % model.beams();
    const double of_echoes = 1.0 - noise.Power(bin, beam) / mean[pixel];
    weight(pixel) =
        parameters_.receiver.looks * cells_per_pixel_ * ShareOfRepeat(of_echoes * of_echoes, before);
  }
  const Eigen::Map<const RowMajor> jacobian(terms.eta_jacobian.data(), pixels, count);
  const Eigen::MatrixXd information =
      scale.asDiagonal() * (jacobian.transpose() * weight.asDiagonal() * jacobian) * scale.asDiagonal();
  return options_.poses ? WithoutOwnPose(information) : information;
}

std::vector<Eigen::MatrixXd> FrameInformation::Of(const std::vector<int>& poses,
                                                  const std::vector<int>& frames_before) const {
  std::vector<Eigen::MatrixXd> information;
  for (std::size_t first = 0; first < poses.size(); first += kFramesAtOnce) {
    std::vector<AcousticFrame> frames;
    for (std::size_t i = first; i < std::min(poses.size(), first + kFramesAtOnce); ++i)
      frames.push_back(FrameAt(poses[i]));
    AcousticFrameModel model(*coarse_, frames, parameters_);
    const std::vector<int> active = ParametersOf(model.catalog(), options_);
    std::vector<int> placement;
    std::ranges::copy_if(active, std::back_inserter(placement),
                         [&](int index) { return IsPlacement(model.catalog()[index]); });
    if (!placement.empty()) model.Linearise(model.initial_values(), placement);
    for (int frame = 0; frame < model.frame_count(); ++frame) {
      const int before = frames_before.empty() ? 0 : frames_before[first + frame];
      information.push_back(OfFrame(model, frame, active, before));
    }
  }
  return information;
}

InformationChoice ChooseByInformation(const std::vector<int>& frames_of_pose,
                                      const FrameInformation& information,
                                      const ChooseByInformationOptions& options) {
  std::vector<int> all(frames_of_pose.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  const std::vector<Eigen::MatrixXd> of_first = information.Of(all);
  return ChooseByInformation(
      frames_of_pose,
      [&](int pose, int before) {
        return before == 0 ? of_first[pose] : information.Of({pose}, {before}).front();
      },
      options);
}

}  // namespace sonarcal::calib
