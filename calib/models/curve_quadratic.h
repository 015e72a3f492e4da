// Cost of one curve to second order in its power at the incidence nodes. A fit to it takes microseconds, and
// ends near an optimum of the pixels, from where a fit to them needs few steps.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// About a curve with the power `at` (a value per coarse incidence node).
struct QuadraticCost {
  Eigen::VectorXd at;
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;  // expected information
};

// Each eigenvector of the curvature is a pixel: its residual is linear in the power of the nodes.
class CurveQuadratic final : public FrameModel {
 public:
  // `of`: model with the same catalog; must outlive this one.
  CurveQuadratic(const FrameModel& of, int material, const QuadraticCost& cost);

  const std::vector<CatalogEntry>& catalog() const override { return of_.catalog(); }
  int frame_count() const override { return 1; }
  int frame_index(int /*frame*/) const override { return 0; }
  int range_bins() const override { return static_cast<int>(offset_.size()); }
  int beams() const override { return 1; }
  bool Counts(int /*frame*/, std::size_t /*pixel*/) const override { return true; }
  bool ShowsMaterial(int material) const override { return material == material_; }
  const std::vector<std::string>& material_names() const override { return of_.material_names(); }
  bool IsLikelihood() const override { return true; }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

 private:
  const FrameModel& of_;
  int material_;
  Eigen::MatrixXd by_node_;  // residuals = by_node_ * power of the nodes + offset_
  Eigen::VectorXd offset_;
};

}  // namespace sonarcal::calib
