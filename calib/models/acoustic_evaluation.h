// A frame of the acoustic model at one set of values: the mean power of each pixel, its derivatives, and the
// likelihood of what was recorded there. This is where a fit of the acoustic model spends its time.
//
// Curves are tabulated once for all pixels, with their derivatives; a pixel then sums its few incidence
// nodes, material by material, and those of its ghosts, way by way.
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

// What was recorded in a frame.
struct RecordedFrame {
  std::span<const RecordedPower> power;  // range_bins x beams
  std::span<const std::uint8_t> use;     // 1 for the pixels that count; empty: all
  std::span<const float> weight;         // of each pixel's likelihood, 0..1; empty: 1
  std::span<const float> repeat_share;   // likewise, for other frames of its pose; empty: 1
};

// What a unit of a geometric parameter does to the echoes of a frame. Of beam and pulse it adds echoes by
// incidence, as levels of curves hang on them; of a pose it multiplies, whatever the curves, as a flank that
// moves grows by its own parts and never falls below nothing.
struct EchoSlope {
  int entry = 0;  // of the catalog
  sim::PixelEchoes echoes = {};
  sim::PixelEchoes ghosts = {};       // laid out as GhostEchoes::pixels of the frame; empty: none
  std::vector<float> logarithm = {};  // d ln(power) by pixel; empty: by echoes
};

struct FrameEchoes {
  sim::PixelEchoes at_point;
  sim::GhostEchoes ghosts = {};
  std::vector<EchoSlope> slopes = {};
};

// What a model knows before it looks at a frame.
struct AcousticState {
  const std::vector<CatalogEntry>& catalog;
  const std::vector<std::string>& material_names;
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
  const ParameterSet& parameters;
  const ParameterValues& values;
  const ParameterValues& point;  // about which echoes are linear
  bool clips = true;             // whether pixels may end at the display's ends
};

class AcousticEvaluation final : public FrameEvaluation {
 public:
  // Echoes and recorded frame must outlive the evaluation.
  AcousticEvaluation(const AcousticState& state, const FrameEchoes& echoes, const RecordedFrame& recorded,
                     std::span<const int> active, FrameModel::Terms wanted);

  bool Bins(int first, int last, PixelTerms& terms) const override;

  // Mean power of every pixel.
  std::vector<double> Means() const;

 private:
  // What a column of the Jacobian is of.
  enum class Of { kCurve, kLevel, kNoise, kNoiseSlope, kGeometry, kMirror, kNothing };
  struct Column {
    Of of = Of::kNothing;
    std::size_t geometry = 0;  // among a pixel's slopes
    int mirror = 0;            // a material
  };
  struct CurveColumn {
    std::size_t column = 0;
    std::size_t sum = 0;  // among a pixel's sums
  };
  // Pixels that count, one after the other.
  struct Sums {
    std::vector<double> curves;  // kCurveStride for each material of each pixel
    std::vector<double> ghosts;  // power of each pixel, by way
    std::vector<double> slopes;  // of each pixel, by geometric parameter
    std::vector<double> power;   // all materials together
    std::vector<double> mean;
    std::vector<double> of_echo;   // d ln mean / d echo power
    std::vector<double> of_noise;  // and / d noise level, dB
  };

  Column PlanColumn(const AcousticState& state, int entry) const;
  // False where a mean is not a positive number.
  bool SumEchoes(std::span<const std::uint32_t> pixels, Sums& sums) const;
  // What moving by geometric parameters adds to one pixel's sums.
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
  std::vector<double> curves_;   // kCurveStride for each node of each material
  std::vector<double> parts_;    // and of each part of each, for ghosts
  std::vector<double> passed_;   // of power by the mirrors of each way
  std::vector<double> moved_;    // of each geometric parameter, from the point
  std::vector<double> gain_;     // by bin
  std::vector<double> range_m_;  // by bin
  sim::ReceiverNoise noise_;
  double looks_;
  bool clips_;
  double lowest_;  // power at the bottom of the display, and at its top
  double highest_;
};

}  // namespace sonarcal::calib
