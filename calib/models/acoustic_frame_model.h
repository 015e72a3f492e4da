// The acoustic model for a fit. eta is the logarithm of the mean power
//
//   mu(r, b) = 10^((SL + G + TVG(r)) / 10) S(r, b) + N(r, b),
//
// with S the echoes of the scene through beam and pulse (sim/gathered/pixel_echoes.h) and N the noise floor.
// The residual is that of speckle with a fixed number of looks (calib/models/power_likelihood.h).
//
// Backscatter curves and receiver are exact. Parameters that decide where an echo arrives (beam, pulse, pose)
// enter by the gathered echoes and their differences about a point; the model is nearly linear in them there.
// `Linearise` moves the point, traces and gathers again. Ghosts by the mirrors of the parameters are part of
// S. Their losses are exact too, and they are gathered from one trace per point
// (sim/gathered/ghost_echoes.h).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calib/models/acoustic_evaluation.h"
#include "calib/models/frame_model.h"
#include "calib/models/move_slopes.h"
#include "calib/models/placed_simulators.h"
#include "calib/models/power_likelihood.h"
#include "core/types/image.h"
#include "core/types/parameters.h"
#include "core/types/pings.h"
#include "core/types/pose.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

struct PixelBlock;

struct AcousticFrame {
  int index = 0;  // in the recording
  Pose world_from_sonar;
  std::vector<RecordedPower> recorded;  // range_bins x beams
  std::vector<std::uint8_t> use = {};   // 1 for used pixels; empty: all
  // Pings with their own poses, relative to that of the frame, which they follow; empty: one pose.
  std::vector<PingPose> pings = {};
};

// Powers behind the grey values of an image. Values at the ends of the display, and those at which a
// saturated receiver piles up (core/imaging/saturation.h), are censored.
std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display);

// Returns the size of a cell of speckle, at least one pixel. `complete`: parameters with the actual beam and
// pulse (sim::WithResponse).
FrameModel::SpeckleCell SpeckleCellOf(const PolarAxes& axes, const ParameterSet& complete);

class AcousticFrameModel final : public FrameModel {
 public:
  // Simulator and frames must outlive the model. Traces every frame. Throws DataError if a frame does not fit
  // the sonar, a material of the scene has no parameters, or there is no noise level. `objects`: names of the
  // parts of the scene that may stand elsewhere. `outlines`: those whose outline may be another.
  AcousticFrameModel(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                     const ParameterSet& initial, const std::vector<std::string>& objects = {},
                     const std::vector<std::string>& outlines = {});
  // Refused: the frames would be gone.
  AcousticFrameModel(const sim::Simulator& simulator, std::vector<AcousticFrame>&& frames,
                     const ParameterSet& initial, const std::vector<std::string>& objects = {},
                     const std::vector<std::string>& outlines = {}) = delete;
  // Model of the same frames and parameters by the rays of another simulator of the same scene and sonar,
  // traced about `values` as Linearise does.
  AcousticFrameModel(const AcousticFrameModel& other, const sim::Simulator& simulator,
                     const ParameterValues& values, const std::vector<int>& geometric)
      : AcousticFrameModel(other, simulator, values, geometric, /*keeps_echoes=*/true) {}
  // As above, for one use of each frame: traces and gathers a frame when it is evaluated, so that the memory
  // is that of one frame. Changes of the scene need all frames at once and keep them.
  static AcousticFrameModel OneFrameAtATime(const AcousticFrameModel& other, const sim::Simulator& simulator,
                                            const ParameterValues& values, const std::vector<int>& geometric);

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
  SpeckleCell speckle_cell() const override;
  int first_of_pose(int frame) const override;
  bool IsLikelihood() const override { return true; }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

  const sim::Simulator& simulator() const { return simulator_; }
  const SonarModel& sonar() const { return simulator_.sonar(); }           // as declared
  const SonarModel& sonar_at_point() const { return at_point_->sonar(); }  // of the last Linearise
  const AcousticFrame& frame(int frame) const { return frames_[frame]; }

  // Simulator with the sonar's geometry and the objects at these values. Not for use in a parallel loop.
  std::shared_ptr<const sim::Simulator> SimulatorAt(const ParameterValues& values) const {
    return placed_.At(catalog_, values);
  }
  // A simulator and rays to trace with it.
  struct Rays {
    std::shared_ptr<const sim::Simulator> simulator;
    sim::RayFan fan;
  };
  // Returns the rays at these values with rows and columns divided by this factor, or by a smaller one if few
  // rows would remain.
  Rays RaysAt(const ParameterValues& values, int decimation) const;
  // Returns the rays of another fan at these values.
  Rays RaysAt(const ParameterValues& values, const sim::RayFanOptions& fan) const;
  // Mean power of the echoes of a frame if it had this pose, without noise. Ghosts have the same decimation
  // as the rays. Not linearised.
  Grid<double> EchoPowerFrom(int frame, const Pose& world_from_sonar, const ParameterSet& parameters,
                             const Rays& rays) const;
  // Mean power including the noise floor.
  PolarImage ExpectedPowerFrom(int frame, const Pose& world_from_sonar, const ParameterSet& parameters,
                               const Rays& rays) const;

  // Slopes of the echoes of all beams from one pose, at the simulator for these values. `objects`: also those
  // along moves of objects, of which SlopeAlongObject gives one entry.
  MoveSlopes SlopesFrom(const sim::Simulator& simulator, const Pose& world_from_sonar,
                        const ParameterValues& values, bool objects) const;
  Grid<float> SlopeAlongObject(const MoveSlopes& slopes, int entry, const Pose& world_from_sonar,
                               const ParameterValues& values) const;

  // Half of -2 log likelihood per frame, as half the sum of squared residuals is, from images traced with a
  // fan. Gathers nothing, so it costs far less than Linearise. Infinite if an image has no value.
  std::vector<double> TracedCosts(const ParameterValues& values, const sim::RayFanOptions& fan) const;
  // Their sum.
  double TracedCost(const ParameterValues& values, const sim::RayFanOptions& fan) const;

  const ParameterValues& initial_values() const { return initial_values_; }
  // Returns the parameters with these values. Those without a catalog entry keep their initial value.
  ParameterSet Parameters(const ParameterValues& values) const;
  // Pose of the array: that of the frame, followed by the mount offset and the tilt that all frames share.
  Pose PoseOf(int frame, const ParameterValues& values) const;
  // Offset of the mount, with the tilt.
  Pose MountOf(const ParameterValues& values) const {
    return Tilted(PoseEntries(kMountFrame, values), GeometryOf(catalog_, values));
  }

  // Number of different poses among the frames, as given.
  int distinct_poses() const;

  // Moves the point about which geometry is linear. `geometric`: the catalog entries that will be active.
  // Echoes of the last point are kept if no geometric value changed.
  void Linearise(const ParameterValues& values, const std::vector<int>& geometric);

  // Frees the memory of the echoes. Nothing can be evaluated before the next Linearise.
  void DropEchoes();

  // Reduces the weight of pixels that do not match the scene at these values (calib/models/down_weight.h).
  void DownWeight(const ParameterValues& values);
  const std::vector<float>& weights(int frame) const { return weights_[frame]; }  // empty: all are 1

  // Returns true if any pose has several frames.
  bool has_repeats() const { return distinct_poses() < frame_count(); }

  // Weights frames of one pose by the information that they have together at these values. While nothing
  // moves, the powers of two such frames have the correlation rho = (S / mu)^2, with S the echoes' part of
  // the mean mu. So n frames count as n / (1 + (n - 1) rho): as one if there is only speckle, as n if there
  // is only noise. Without this, frozen speckle would count n times against the priors.
  void ShareRepeats(const ParameterValues& values);
  // Takes the weights of another model of these frames. Throws std::invalid_argument if they belong to other
  // pixels.
  void TakeRepeatShares(const std::vector<std::vector<float>>& shares);
  const std::vector<std::vector<float>>& repeat_shares() const { return repeat_shares_; }

  // Mean power of a frame's pixels.
  std::vector<double> MeanPower(int frame, const ParameterValues& values) const;

  // Weight of a pixel's likelihood: product of the weights of DownWeight and ShareRepeats.
  double Weight(int frame, std::size_t pixel) const {
    const double share = repeat_shares_[frame].empty() ? 1.0 : repeat_shares_[frame][pixel];
    return share * (weights_[frame].empty() ? 1.0 : weights_[frame][pixel]);
  }

  // Echoes per frame about the point of the last Linearise.
  const std::vector<FrameEchoes>& echoes() const { return echoes_; }

  std::unique_ptr<FrameModel> Coarse(std::size_t wanted_pixels) const override;
  std::unique_ptr<FrameModel> CoarseAbout(const ParameterValues& values,
                                          std::size_t wanted_pixels) const override;

 private:
  AcousticFrameModel(const AcousticFrameModel& other, const sim::Simulator& simulator,
                     const ParameterValues& values, const std::vector<int>& geometric, bool keeps_echoes);
  Pose PoseEntries(int frame, const ParameterValues& values) const;
  AcousticState StateAt(const ParameterSet& parameters, const ParameterValues& values) const;
  // Echoes of a frame at two sets of values, and the difference of these values.
  struct EchoPair {
    Grid<double> above;
    Grid<double> below;
    double difference;
  };
  // Difference of the logarithms of the echoes, divided by that of the values.
  std::vector<float> LogarithmSlope(const EchoPair& echoes, const ParameterSet& parameters) const;
  // Echoes far below the noise have no effect. This floor, added to them, keeps their logarithm constant.
  Grid<double> FloorOfEchoes(const ParameterSet& parameters) const;
  // Ghosts from a pose, as far beside the beams as a free transmitter angle may reach.
  sim::GhostList GhostsOf(const sim::Simulator& simulator, const Pose& world_from_sonar,
                          const ParameterValues& values, const std::vector<int>& geometric) const;
  static Grid<double> EchoPowerFrom(const Pose& world_from_sonar, const ParameterSet& parameters,
                                    const Rays& rays);
  bool HasSlopes() const;
  // Block of pixels for a coarse model; nullopt if that would be no cheaper.
  std::optional<PixelBlock> BlockFor(std::size_t wanted_pixels) const;
  std::vector<FrameEchoes> FramesAbout(const sim::Simulator& simulator, const ParameterValues& values,
                                       const std::vector<int>& geometric) const;
  FrameEchoes EchoesAbout(const sim::Simulator& simulator, int frame, const ParameterValues& values,
                          const std::vector<int>& geometric) const;
  FrameEchoes EchoesFrom(const sim::Simulator& simulator, const Pose& world_from_sonar,
                         const ParameterValues& values, const std::vector<int>& geometric) const;
  // True if the echoes about the present point serve for other values, and these entries have no slope by
  // gathered echoes.
  bool KeepsEchoes(const ParameterValues& values, const std::vector<int>& geometric) const;

  // Slopes along poses, axes and objects from those along moves of the sonar and of parts. A turn of the
  // sonar and a turn of its beams then cancel exactly, as they do in an image; separate slopes would seem to
  // tell them apart.
  void AddSlopesOfMoves(const sim::Simulator& simulator, int frame, const ParameterValues& values,
                        const std::vector<int>& geometric, FrameEchoes& echoes) const;
  // Adds the slopes of the beams of one ping of the frame to those of `entries`.
  void AddSlopesOfPing(const sim::Simulator& simulator, int frame, const PingPose& ping,
                       const ParameterValues& values, const std::vector<int>& entries,
                       std::vector<std::vector<float>>& slopes) const;
  // Slopes along changes of the scene that are no rigid moves: scales of objects and outlines.
  void AddSlopesOfScene(const ParameterValues& values, const std::vector<int>& geometric,
                        std::vector<FrameEchoes>& echoes) const;

  const sim::Simulator& simulator_;
  std::vector<std::string> objects_;
  std::vector<std::string> outlines_;
  PlacedSimulators placed_;
  std::shared_ptr<const sim::Simulator> at_point_;
  const std::vector<AcousticFrame>& frames_;
  std::vector<std::string> material_names_;
  ParameterSet initial_;
  std::vector<CatalogEntry> catalog_;
  ParameterValues initial_values_;
  ParameterValues point_;
  bool keeps_echoes_ = true;
  std::vector<int> geometric_;  // of the last Linearise
  std::vector<FrameEchoes> echoes_;
  std::vector<std::vector<float>> weights_;
  std::vector<std::vector<float>> repeat_shares_;
  std::vector<int> first_of_pose_;
  std::vector<bool> shown_;      // per material: any frame has an echo of it
  std::vector<bool> reflected_;  // per material: any frame has a ghost by way of it
};

}  // namespace sonarcal::calib
