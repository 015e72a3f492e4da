// A frame of the acoustic model at one set of values: the mean power of each pixel, its derivatives, and the
// likelihood of the recorded values. A fit of the acoustic model spends most of its time here.
//
// Curves and their derivatives are tabulated once for all pixels. A pixel then sums its few incidence nodes,
// material by material, and those of its ghosts, path by path.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"
#include "calib/models/power_likelihood.h"
#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "sim/gathered/ghost_echoes.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {

// Recorded data of a frame.
struct RecordedFrame {
  std::span<const RecordedPower> power;  // range_bins x beams
  std::span<const std::uint8_t> use;     // 1 for used pixels; empty: all
  std::span<const float> weight;         // weight of each pixel's likelihood, 0..1; empty: 1
  // weight that accounts for other frames of the same pose, 0..1; empty: 1
  std::span<const float> repeat_share;
};

// Change of the echoes of a frame per unit of a geometric parameter. Beam and pulse add echoes by incidence,
// which the levels of curves multiply. A pose multiplies the power, whatever the curves, so that a moving
// edge grows in proportion and never becomes negative.
struct EchoSlope {
  int entry = 0;  // catalog entry
  sim::PixelEchoes echoes = {};
  sim::PixelEchoes ghosts = {};       // in the layout of GhostEchoes::pixels of the frame; empty: none
  std::vector<float> logarithm = {};  // d ln(power) per pixel; empty: by echoes
};

struct FrameEchoes {
  sim::PixelEchoes at_point;
  sim::GhostEchoes ghosts = {};
  std::vector<EchoSlope> slopes = {};
};

// State of a model that is common to all frames.
struct AcousticState {
  const std::vector<CatalogEntry>& catalog;
  const std::vector<std::string>& material_names;
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
  const ParameterSet& parameters;
  const ParameterValues& values;
  const ParameterValues& point;  // about which echoes are linear
  bool clips = true;             // whether pixels may be clipped by the display
};

// Appends the power of a curve and its derivatives by A to F, kCurveStride values per coarse incidence node.
void AppendCurve(const GsabParameters<double>& gsab, std::vector<double>& table);

class AcousticEvaluation final : public FrameEvaluation {
 public:
  // Echoes and recorded frame must outlive the evaluation.
  AcousticEvaluation(const AcousticState& state, const FrameEchoes& echoes, const RecordedFrame& recorded,
                     std::span<const int> active, FrameModel::Terms wanted);

  bool Bins(int first, int last, PixelTerms& terms) const override;

  // Mean power of every pixel.
  std::vector<double> Means() const;

  // Factor of the power of echoes in a range bin.
  double gain(int bin) const { return gain_[bin]; }
  // kCurveStride values per coarse incidence node and material, as AppendCurve makes them.
  const std::vector<double>& curves() const { return curves_; }

 private:
  // Kind of a Jacobian column.
  enum class Of { kCurve, kLevel, kNoise, kNoiseSlope, kGeometry, kMirror, kNothing };
  struct Column {
    Of of = Of::kNothing;
    std::size_t geometry = 0;  // index among a pixel's slopes
    int mirror = 0;            // material index
  };
  struct CurveColumn {
    std::size_t column = 0;
    std::size_t sum = 0;  // index among a pixel's sums
  };
  // Sums over the used pixels, one after the other.
  struct Sums {
    std::vector<double> curves;  // kCurveStride values per material and pixel
    std::vector<double> ghosts;  // power per pixel and path
    std::vector<double> slopes;  // per pixel and geometric parameter
    std::vector<double> power;   // sum over all materials
    std::vector<double> mean;
    std::vector<double> of_echo;   // d ln mean / d echo power
    std::vector<double> of_noise;  // d ln mean / d noise level, dB
  };

  Column PlanColumn(const AcousticState& state, int entry) const;
  // Returns false if a mean is not a positive number.
  bool SumEchoes(std::span<const std::uint32_t> pixels, Sums& sums) const;
  // Change of one pixel's sums by geometric parameters.
  struct Scratch {
    std::vector<double> curves;
    std::vector<double> ghosts;
  };
  void MoveGeometry(std::uint32_t pixel, std::size_t i, Scratch& scratch, Sums& sums) const;
  void FillLikelihood(std::span<const std::uint32_t> pixels, const std::vector<double>& mean,
                      std::size_t first_pixel, PixelTerms& terms) const;
  void FillJacobian(std::span<const std::uint32_t> pixels, const Sums& sums, std::size_t first_pixel,
                    double* jacobian) const;
  double Information(double mean) const {
    return clips_ ? ExpectedInformation(lowest_, highest_, mean, looks_) : looks_;
  }
  bool Counts(std::size_t pixel) const { return recorded_.use.empty() || recorded_.use[pixel] != 0; }
  double AllMaterials(const double* curves) const {
    double power = 0.0;
    for (std::size_t material = 0; material < materials_; ++material)
      power += curves[material * sim::kCurveStride];
    return power;
  }

  const FrameEchoes& echoes_;
  RecordedFrame recorded_;
  FrameModel::Terms wanted_;
  int bins_;
  int beams_;
  std::size_t materials_;
  std::vector<Column> columns_;
  std::vector<CurveColumn> curve_columns_;
  std::vector<double> curves_;              // kCurveStride values per node and material
  std::vector<double> parts_;               // kCurveStride values per node, part and material, for ghosts
  std::vector<double> passed_;              // power that the mirrors of each path leave
  std::vector<double> moved_;               // change of each geometric parameter from the point
  std::vector<std::size_t> needed_slopes_;  // those that moved or are differentiated
  std::vector<double> gain_;                // per bin
  std::vector<double> range_m_;             // per bin
  sim::ReceiverNoise noise_;
  double looks_;
  bool clips_;
  double lowest_;  // power at the bottom of the display; below, at its top
  double highest_;
};

}  // namespace sonarcal::calib
