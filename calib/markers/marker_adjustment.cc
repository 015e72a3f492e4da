#include "calib/markers/marker_adjustment.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "calib/markers/marker_cost.h"
#include "core/types/error.h"
#include "core/types/rotation.h"

namespace sonarcal::calib {
namespace {

using Block = std::array<double, 6>;

constexpr int kNoiseRounds = 4;  // of poses and noise in turn; the factor is then constant to 1/1000

// Offset of a marker from its place in the map, in standard deviations.
struct MapPrior {
  MarkerMapSigma sigma;

  template <typename T>
  bool operator()(const T* step, T* residual) const {
    for (int k = 0; k < 3; ++k) {
      residual[k] = step[k] / sigma.position_m;
      residual[3 + k] = step[3 + k] / sigma.angle_rad;
    }
    return true;
  }
};

class Adjuster {
 public:
  Adjuster(std::vector<AdjustedFrame> frames, MarkerMap map, const Camera& camera, const FlatPort* port,
           bool refine_focal)
      : frames_(std::move(frames)),
        map_(std::move(map)),
        camera_(camera),
        port_(port),
        refine_focal_(refine_focal) {
    for (const AdjustedFrame& frame : frames_) {
      references_.push_back(frame.world_from_camera.rotation);
      const Eigen::Vector3d& p = frame.world_from_camera.position_m;
      blocks_.push_back({p.x(), p.y(), p.z()});
      for (const MarkerObservation& seen : frame.seen) steps_.try_emplace(seen.id, Block{});
    }
  }

  Adjustment Run(double noise_factor2) {
    for (int round = 0; round < kNoiseRounds; ++round) {
      Build(noise_factor2);
      Solve();
      noise_factor2 = NewFactor(noise_factor2);
      MoveReferences();
    }
    Build(noise_factor2);
    Adjustment result;
    result.map = map_;
    result.noise_factor2 = noise_factor2;
    result.degrees_of_freedom = freedom_;
    result.focal_scale = focal_;
    AddCovariance(result);
    for (Marker& marker : result.map.markers) {
      const auto step = steps_.find(marker.id);
      if (step == steps_.end()) continue;
      const Block& s = step->second;
      marker.world_from_marker.position_m += Eigen::Vector3d(s[0], s[1], s[2]);
      marker.world_from_marker.rotation = Turned(marker.world_from_marker.rotation, {s[3], s[4], s[5]});
    }
    result.frames = std::move(frames_);
    return result;
  }

 private:
  void Build(double noise_factor2) {
    problem_ = std::make_unique<ceres::Problem>();
    marker_blocks_.clear();
    prior_blocks_.clear();
    const double per_sigma = 1.0 / std::sqrt(noise_factor2);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (const MarkerObservation& seen : frames_[i].seen) {
        auto* cost = new MarkerCost{.camera = &camera_,
                                    .port = port_,
                                    .marker = *map_.Find(seen.id),
                                    .world_from_camera_reference = &references_[i],
                                    .corners_px = seen.corners_px,
                                    .whiten = per_sigma * WhiteningOf(seen.covariance_px2)};
        marker_blocks_.push_back(problem_->AddResidualBlock(
            new ceres::AutoDiffCostFunction<MarkerCost, 8, 6, 6, 1>(cost), new ceres::HuberLoss(kMarkerHuber),
            blocks_[i].data(), steps_.at(seen.id).data(), &focal_));
      }
    }
    for (auto& [id, step] : steps_) {
      if (map_.sigma) {
        prior_blocks_.push_back(problem_->AddResidualBlock(
            new ceres::AutoDiffCostFunction<MapPrior, 6, 6>(new MapPrior{*map_.sigma}), nullptr,
            step.data()));
      } else {
        problem_->SetParameterBlockConstant(step.data());
      }
    }
    if (!refine_focal_) problem_->SetParameterBlockConstant(&focal_);
  }

  void Solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-12;
    options.parameter_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, problem_.get(), &summary);
    if (!summary.IsSolutionUsable())
      throw DataError("the poses of {} frames could not be refined together: {}", frames_.size(),
                      summary.message);
  }

  double SquaredNorm(ceres::ResidualBlockId block, bool weighted) const {
    double cost = 0.0;
    std::array<double, 8> residual{};
    problem_->EvaluateResidualBlock(block, false, &cost, residual.data(), nullptr);
    const double squared = 2.0 * cost;
    // Huber's weight, as in the solution.
    const double length = std::sqrt(squared);
    return weighted && length > kMarkerHuber ? kMarkerHuber * length : squared;
  }

  double NewFactor(double noise_factor2) {
    double sum = 0.0;
    for (const ceres::ResidualBlockId block : marker_blocks_) sum += SquaredNorm(block, true);
    double priors = 0.0;
    for (const ceres::ResidualBlockId block : prior_blocks_) priors += SquaredNorm(block, false);
    freedom_ = 8.0 * static_cast<double>(marker_blocks_.size()) - 6.0 * static_cast<double>(frames_.size()) -
               (refine_focal_ ? 1.0 : 0.0) - priors;
    if (!(freedom_ > 0.0)) {
      throw DataError(
          "{} markers in {} frames leave no degree of freedom to estimate the noise, expected more",
          marker_blocks_.size(), frames_.size());
    }
    return std::max(1e-6, noise_factor2 * sum / freedom_);
  }

  void MoveReferences() {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      Block& block = blocks_[i];
      references_[i] = Turned(references_[i], {block[3], block[4], block[5]});
      block[3] = block[4] = block[5] = 0.0;
      frames_[i].world_from_camera = {references_[i], {block[0], block[1], block[2]}};
    }
  }

  void AddCovariance(Adjustment& result) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    options.apply_loss_function = true;
    ceres::Covariance covariance(options);
    std::vector<std::pair<const double*, const double*>> wanted;
    for (const Block& block : blocks_) wanted.emplace_back(block.data(), block.data());
    if (refine_focal_) wanted.emplace_back(&focal_, &focal_);
    if (!covariance.Compute(wanted, problem_.get())) {
      throw DataError(
          "the markers in {} frames do not determine {}", frames_.size(),
          refine_focal_ ? "poses and focal length together: fix the focal length" : "their poses");
    }
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
      covariance.GetCovarianceBlock(blocks_[i].data(), blocks_[i].data(), block.data());
      frames_[i].covariance = block;
    }
    if (!refine_focal_) return;
    double variance = 0.0;
    covariance.GetCovarianceBlock(&focal_, &focal_, &variance);
    result.focal_scale_sigma = std::sqrt(variance);
  }

  std::vector<AdjustedFrame> frames_;
  MarkerMap map_;
  const Camera& camera_;
  const FlatPort* port_;
  const bool refine_focal_;
  std::vector<Eigen::Quaterniond> references_;
  std::vector<Block> blocks_;
  std::map<int, Block> steps_;  // of the visible markers
  double focal_ = 1.0;
  double freedom_ = 0.0;
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<ceres::ResidualBlockId> marker_blocks_;
  std::vector<ceres::ResidualBlockId> prior_blocks_;
};

}  // namespace

Adjustment Adjust(std::vector<AdjustedFrame> frames, const MarkerMap& map, const Camera& camera,
                  const FlatPort* port, bool refine_focal, double noise_factor2) {
  return Adjuster(std::move(frames), map, camera, port, refine_focal).Run(noise_factor2);
}

}  // namespace sonarcal::calib
