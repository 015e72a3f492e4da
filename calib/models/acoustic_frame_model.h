// The acoustic model as a fit sees it: eta is the logarithm of the mean power
//
//   mu(r, b) = 10^((SL + G + TVG(r)) / 10) S(r, b) + N(r, b),
//
// S the echoes of the scene through beam and pulse (sim/gathered/pixel_echoes.h), N the noise floor; and the
// residual is that of speckle with a fixed number of looks (calib/models/power_likelihood.h).
//
// Backscatter curves and receiver are exact. What decides where an echo arrives (beam, pulse, pose) enters by
// the gathered echoes and their differences about a point, the model being linear in it near there:
// `Linearise` moves the point, and traces and gathers again. Ghosts by the mirrors of the parameters are part
// of S: exact in their losses, too, and gathered from one trace a point (sim/gathered/ghost_echoes.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/models/acoustic_evaluation.h"
#include "calib/models/frame_model.h"
#include "calib/models/power_likelihood.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

struct AcousticFrame {
  int index = 0;  // in the recording
  Pose world_from_sonar;
  std::vector<RecordedPower> recorded;  // range_bins x beams
  std::vector<std::uint8_t> use = {};   // 1 for the pixels that count; empty: all
};

// The powers behind an image's grey values: what its display shows as a value, or as its ends.
std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display);

class AcousticFrameModel final : public FrameModel {
 public:
  // Simulator and frames must outlive the model. Traces every frame. Throws DataError where a frame does not
  // fit the sonar, a material of the scene has no parameters, or there is no noise level.
  AcousticFrameModel(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                     const ParameterSet& initial);

  const std::vector<CatalogEntry>& catalog() const override { return catalog_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  int frame_index(int frame) const override { return frames_[frame].index; }
  int range_bins() const override { return simulator_.sonar().axes.range_bins; }
  int beams() const override { return simulator_.sonar().axes.beam_count(); }
  bool Counts(int frame, std::size_t pixel) const override {
    return frames_[frame].use.empty() || frames_[frame].use[pixel] != 0;
  }
  bool ShowsMaterial(int material) const override { return shown_[material]; }
  bool ShowsMirror(int material) const override { return reflected_[material]; }
  const std::vector<std::string>& material_names() const override { return material_names_; }
  Grain grain() const override;
  int first_of_pose(int frame) const override;
  bool IsLikelihood() const override { return true; }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

  const sim::Simulator& simulator() const { return simulator_; }
  const SonarModel& sonar() const { return simulator_.sonar(); }
  const AcousticFrame& frame(int frame) const { return frames_[frame]; }
  // Mean power of the echoes from a pose, without noise: traces a fan of rays, and ghosts by one thinned as
  // much, and is linear in nothing.
  Grid<double> EchoPowerFrom(const Pose& world_from_sonar, const ParameterSet& parameters,
                             const sim::RayFan& fan) const;
  // Mean power including the noise floor.
  PolarImage ExpectedPowerFrom(const Pose& world_from_sonar, const ParameterSet& parameters,
                               const sim::RayFan& fan) const;
  // The simulator's fan with fewer rows and columns by this factor.
  sim::RayFan ThinnedFan(int factor) const;

  const ParameterValues& initial_values() const { return initial_values_; }
  // The parameters with these values, and what no catalog entry names as given at first.
  ParameterSet Parameters(const ParameterValues& values) const;
  // The frame's own pose, then the mount offset that all share.
  Pose PoseOf(int frame, const ParameterValues& values) const;
  Pose MountOf(const ParameterValues& values) const { return PoseEntries(kMountFrame, values); }

  // Moves the point that geometry is taken about; `geometric` are the catalog entries that will be active.
  void Linearise(const ParameterValues& values, const std::vector<int>& geometric);

  // Lets the pixels that the scene does not explain at these values count less (calib/models/down_weight.h).
  void DownWeight(const ParameterValues& values);
  const std::vector<float>& weights(int frame) const { return weights_[frame]; }  // empty: all count in full

  // Whether any pose has several frames.
  bool has_repeats() const;

  // Lets frames of one pose count together for what they tell together at these values. While nothing moves,
  // powers of two of them are correlated by rho = (S / mu)^2, S the echoes' part of the mean mu, so that n of
  // them are worth n / (1 + (n - 1) rho): one where speckle is all there is, n where noise is. Without this a
  // frozen speckle would be believed n times as much as what was known beforehand.
  void ShareRepeats(const ParameterValues& values);

  // Mean power of a frame's pixels.
  std::vector<double> MeanPower(int frame, const ParameterValues& values) const;

  // By how much a pixel's likelihood counts: for what the scene explains, and what other frames tell too.
  double Weight(int frame, std::size_t pixel) const {
    const double share = repeat_shares_[frame].empty() ? 1.0 : repeat_shares_[frame][pixel];
    return share * (weights_[frame].empty() ? 1.0 : weights_[frame][pixel]);
  }

  // The echoes of a frame about the point of the last Linearise.
  const FrameEchoes& echoes(int frame) const { return echoes_[frame]; }

  std::unique_ptr<FrameModel> Coarse(std::size_t wanted_pixels) const override;

 private:
  Pose PoseEntries(int frame, const ParameterValues& values) const;
  sim::AcousticGeometry geometry() const { return {simulator_.sonar(), simulator_.absorption_db_per_m()}; }
  AcousticState StateAt(const ParameterSet& parameters, const ParameterValues& values) const;
  // Difference of the logarithms of the echoes of a frame's two poses, over `difference`.
  std::vector<float> LogarithmSlope(int frame, const ParameterValues& above, const ParameterValues& below,
                                    double difference) const;
  // What a frame's mirrors show of the scene, as far aside as a transmitter that moves may come to send.
  sim::GhostList GhostsOf(int frame, const ParameterValues& values, const std::vector<int>& geometric) const;
  FrameEchoes EchoesAbout(int frame, const ParameterValues& values, const std::vector<int>& geometric) const;

  const sim::Simulator& simulator_;
  const std::vector<AcousticFrame>& frames_;
  std::vector<std::string> material_names_;
  ParameterSet initial_;
  std::vector<CatalogEntry> catalog_;
  ParameterValues initial_values_;
  ParameterValues point_;
  std::vector<FrameEchoes> echoes_;
  std::vector<std::vector<float>> weights_;
  std::vector<std::vector<float>> repeat_shares_;
  std::vector<bool> shown_;      // by material: whether any frame has an echo of it
  std::vector<bool> reflected_;  // or a ghost by way of it
};

}  // namespace sonarcal::calib
