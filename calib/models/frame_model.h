// Forward model of a fit, as a solver sees it: named parameters, and for every pixel of every frame a
// residual and its derivatives by them.
//
// A pixel depends on the parameters through one number eta: the image value in the paper's model, the
// logarithm of the mean power in the acoustic one. Then
//
//   d residual / d parameter = slope x d eta / d parameter
//   expected information     = information x (d eta / d parameter)(d eta / d parameter)^T
//
// Half the sum of squared residuals is the negative log-likelihood up to a constant, and, for the paper's
// model with unknown noise, up to a factor.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "calib/parameters/parameter_catalog.h"

namespace sonarcal::calib {

// Pixels of consecutive range bins, bin by bin. All values of an unused pixel are zero.
struct PixelTerms {
  std::vector<double> residual;
  std::vector<double> slope;         // d residual / d eta
  std::vector<double> information;   // expected square of the score d (residual^2 / 2) / d eta
  std::vector<double> eta_jacobian;  // pixels x active parameters, row by row
  // Factor in residual and slope that accounts for other frames of the same pose; empty: 1 everywhere.
  std::vector<double> repeat_factor = {};
};

// A frame at one set of values. It refers to its model and must be used before the model changes.
class FrameEvaluation {
 public:
  virtual ~FrameEvaluation() = default;

  // Evaluates the range bins [first, last). Thread-safe. Returns false if the model has no value.
  virtual bool Bins(int first, int last, PixelTerms& terms) const = 0;
};

class OneCurveModel;

class FrameModel {
 public:
  virtual ~FrameModel() = default;

  virtual const std::vector<CatalogEntry>& catalog() const = 0;
  virtual int frame_count() const = 0;
  virtual int frame_index(int frame) const = 0;  // index in the recording
  virtual int range_bins() const = 0;
  virtual int beams() const = 0;
  virtual bool Counts(int frame, std::size_t pixel) const = 0;
  virtual bool ShowsMaterial(int material) const = 0;                // in any frame
  virtual bool ShowsMirror(int /*material*/) const { return true; }  // a ghost by way of it, in any frame
  virtual const std::vector<std::string>& material_names() const = 0;

  // Size of a speckle cell in pixels: the half-power widths of pulse and beam. Pixels within it are
  // correlated.
  struct SpeckleCell {
    double bins = 1.0;
    double beams = 1.0;

    double pixels() const { return bins * beams; }
  };
  virtual SpeckleCell speckle_cell() const { return {}; }

  // Returns the first frame of the group of `frame` (core/math/pose_groups.h), or `frame` itself. While
  // nothing moves, speckle stays the same and further frames add little information.
  virtual int first_of_pose(int frame) const { return frame; }

  // Returns true if half the sum of squares is a negative log-likelihood including noise, so that priors can
  // be weighed against it.
  virtual bool IsLikelihood() const = 0;

  // Outputs besides the residuals: none; derivatives for a solver (slope, and Jacobian by the entries
  // `active` of the catalog); or also information.
  enum class Terms { kResiduals, kDerivatives, kInformation };

  // Returns null if the model has no value.
  virtual std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values,
                                              std::span<const int> active, Terms wanted) const = 0;

  // Evaluates a whole frame.
  bool Evaluate(int frame, const ParameterValues& values, std::span<const int> active, Terms wanted,
                PixelTerms& terms) const {
    const auto evaluation = At(frame, values, active, wanted);
    return evaluation != nullptr && evaluation->Bins(0, range_bins(), terms);
  }

  // Returns a model of the same frames in about this number of pixels, for the search of start values; null
  // if that would be no cheaper.
  virtual std::unique_ptr<FrameModel> Coarse(std::size_t /*wanted_pixels*/) const { return nullptr; }

  // As above, for fits of curves and receiver alone: the geometric parameters stay at `values`.
  virtual std::unique_ptr<FrameModel> CoarseAbout(const ParameterValues& /*values*/,
                                                  std::size_t wanted_pixels) const {
    return Coarse(wanted_pixels);
  }

  // Returns a model of the pixels that show this material, with everything but its curve fixed at `values`;
  // null if that would be no cheaper. This model must outlive it.
  virtual std::unique_ptr<OneCurveModel> OfCurve(int material, const ParameterValues& values) const;

  std::size_t pixel_count() const { return static_cast<std::size_t>(range_bins()) * beams(); }
};

}  // namespace sonarcal::calib
