// Models of the pixels that show one material, as functions of its curve alone. Everything else stays, so
// that a pixel is a sum over the incidence nodes of the curve and a constant:
//
//   mean = rest + sum over entries of weight x curve(incidence).
//
// The curve is in power for the acoustic model and in dB for the paper's.
//
// For searches that move one curve many times: other pixels, other materials and the receiver cost nothing.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "calib/models/frame_model.h"
#include "sim/gathered/pixel_echoes.h"

namespace sonarcal::calib {

// One frame with one beam, whose range bins are the pixels.
class FrameOfCurve : public FrameModel {
 public:
  // `of`: model with the same catalog; must outlive this one.
  FrameOfCurve(const FrameModel& of, int material) : of_(of), material_(material) {}

  const std::vector<CatalogEntry>& catalog() const override { return of_.catalog(); }
  int frame_count() const override { return 1; }
  int frame_index(int /*frame*/) const override { return 0; }
  int beams() const override { return 1; }
  bool Counts(int /*frame*/, std::size_t /*pixel*/) const override { return true; }
  bool ShowsMaterial(int material) const override { return material == material_; }
  const std::vector<std::string>& material_names() const override { return of_.material_names(); }
  bool IsLikelihood() const override { return true; }

 protected:
  const FrameModel& of() const { return of_; }
  int material() const { return material_; }
  // Parameters of the curve at these values.
  GsabParameters<double> CurveAt(const ParameterValues& values) const;
  // Column of the table for each entry; 0 for an entry of something else.
  std::vector<std::size_t> CurveColumns(std::span<const int> entries) const;

 private:
  bool IsOfCurve(const CatalogEntry& entry) const {
    return entry.group == ParameterGroup::kGsab && entry.material == material_;
  }

  const FrameModel& of_;
  int material_;
};

// Pixels of all frames, one after the other.
struct OneCurvePixels {
  sim::PixelEchoes echoes = {.materials = 1, .start = {0}, .entries = {}};
  std::vector<double> rest;

  // Adds a pixel if it shows the material; returns whether it does. `gain` multiplies the weights. `table`:
  // kCurveStride values per node and material. `mean`: that of the pixel with this table.
  bool Add(const sim::PixelEchoes& from, std::size_t pixel, int material, double gain,
           std::span<const double> table, double mean);
};

// Curve and likelihood of such pixels.
class PixelLaw {
 public:
  virtual ~PixelLaw() = default;

  // Returns the curve and its derivatives by A to F, kCurveStride values per coarse incidence node.
  virtual std::vector<double> Table(const GsabParameters<double>& curve) const = 0;
  // Sets residuals, their slopes by the mean, and the information on it, of consecutive pixels. All three
  // have the size of `mean`. Thread-safe. Returns false if a pixel has no value.
  virtual bool Judge(std::size_t first, std::span<const double> mean, PixelTerms& terms) const = 0;
};

// Half the sum of its squared residuals is that of the pixels alone. It differs from that of a model of all
// pixels by a constant.
class OneCurveModel final : public FrameOfCurve {
 public:
  OneCurveModel(const FrameModel& of, int material, OneCurvePixels pixels, std::unique_ptr<PixelLaw> law)
      : FrameOfCurve(of, material), pixels_(std::move(pixels)), law_(std::move(law)) {}

  int range_bins() const override { return static_cast<int>(pixels_.rest.size()); }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

  // Returns the cost to second order in the curve at the incidence nodes, about these values. A fit to it
  // takes microseconds, and ends near an optimum of this model. A fit to this model that starts there needs
  // few steps. Null if this model has no value at these values. This model must outlive it.
  std::unique_ptr<FrameModel> Quadratic(const ParameterValues& values) const;

 private:
  OneCurvePixels pixels_;
  std::unique_ptr<PixelLaw> law_;
};

}  // namespace sonarcal::calib
