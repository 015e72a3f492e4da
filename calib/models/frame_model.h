// The forward model of a fit, as a solver sees it: named parameters, and for every pixel of every frame a
// residual and what it tells about them.
//
// A pixel follows the parameters through one number eta: the image value of the paper model, the logarithm of
// the mean power of the acoustic one. Then
//
//   d residual / d parameter = slope x d eta / d parameter
//   expected information     = information x (d eta / d parameter)(d eta / d parameter)^T
//
// and half the sum of squared residuals is the negative log-likelihood, up to a constant and, for the paper
// model as long as its noise is not known, up to a factor.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "calib/parameters/parameter_catalog.h"

namespace sonarcal::calib {

// Pixels of a run of range bins, bin by bin. A pixel that does not count has zeros everywhere.
struct PixelTerms {
  std::vector<double> residual;
  std::vector<double> slope;         // d residual / d eta
  std::vector<double> information;   // expected square of the score d (residual^2 / 2) / d eta
  std::vector<double> eta_jacobian;  // pixels x active parameters, row by row
  // Factor within residual and slope for what frames of one pose tell together; empty: 1 everywhere.
  std::vector<double> repeat_factor = {};
};

// A frame at one set of values. It refers to its model, and is used before the model changes.
class FrameEvaluation {
 public:
  virtual ~FrameEvaluation() = default;

  // The range bins [first, last); from any number of threads. False where the model has no value.
  virtual bool Bins(int first, int last, PixelTerms& terms) const = 0;
};

class FrameModel {
 public:
  virtual ~FrameModel() = default;

  virtual const std::vector<CatalogEntry>& catalog() const = 0;
  virtual int frame_count() const = 0;
  virtual int frame_index(int frame) const = 0;  // in the recording
  virtual int range_bins() const = 0;
  virtual int beams() const = 0;
  virtual bool Counts(int frame, std::size_t pixel) const = 0;
  virtual bool ShowsMaterial(int material) const = 0;                // in any frame
  virtual bool ShowsMirror(int /*material*/) const { return true; }  // a ghost by way of it, in any frame
  virtual const std::vector<std::string>& material_names() const = 0;

  // Over how many pixels beam and pulse spread an echo, by their half-power widths: so far apart, speckle is
  // alike, and pixels are not independent.
  struct Grain {
    double bins = 1.0;
    double beams = 1.0;
  };
  virtual Grain grain() const { return {}; }

  // The first frame that shares a frame's pose, the frame itself where none does: as long as nothing moves
  // speckle stays, and more frames of it tell little more.
  virtual int first_of_pose(int frame) const { return frame; }

  // Whether half the sum of squares is a negative log-likelihood, noise and all: then a prior can be weighed
  // against it.
  virtual bool IsLikelihood() const = 0;

  // Whether derivatives cost little more than the residuals alone.
  virtual bool DerivativesAreCheap() const { return true; }

  // What is asked for besides the residuals: nothing, what a solver needs (slope and Jacobian with respect
  // to the entries `active` of the catalog), or information too.
  enum class Terms { kResiduals, kDerivatives, kInformation };

  // Null where the model has no value.
  virtual std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values,
                                              std::span<const int> active, Terms wanted) const = 0;

  // A whole frame at once.
  bool Evaluate(int frame, const ParameterValues& values, std::span<const int> active, Terms wanted,
                PixelTerms& terms) const {
    const auto evaluation = At(frame, values, active, wanted);
    return evaluation != nullptr && evaluation->Bins(0, range_bins(), terms);
  }

  // About the same frames in about so many pixels, to find a start by; null where that would be no cheaper.
  virtual std::unique_ptr<FrameModel> Coarse(std::size_t /*wanted_pixels*/) const { return nullptr; }

  std::size_t pixel_count() const { return static_cast<std::size_t>(range_bins()) * beams(); }
};

}  // namespace sonarcal::calib
