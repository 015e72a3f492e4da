// The acoustic model as a fit sees it: eta is the logarithm of the mean power
//
//   mu(r, b) = 10^((SL + G + TVG(r)) / 10) S(r, b) + N(r, b),
//
// S the echoes of the scene through beam and pulse (sim/power_response.h), N the noise floor; and the
// residual is that of speckle with a fixed number of looks (calib/power_likelihood.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/frame_model.h"
#include "calib/power_likelihood.h"
#include "data_io/types/parameters.h"
#include "sim/echo_power.h"
#include "sim/pixel_echoes.h"
#include "sim/power_response.h"

namespace sonarcal {

struct AcousticFrame {
  int index = 0;  // in the recording
  EchoPower echoes;
  std::vector<RecordedPower> recorded;  // range_bins x beams
  std::vector<std::uint8_t> use = {};   // 1 for the pixels that count; empty: all
};

// The powers behind an image's grey values: what its display shows as a value, or as its ends.
std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display);

class AcousticFrameModel final : public FrameModel {
 public:
  // Frames must outlive the model. Throws DataError where a frame does not fit the sonar, a material of the
  // scene has no parameters, or there is no noise level. Where the response (beam and pulse) is fixed, the
  // echoes are sent through it once (sim/pixel_echoes.h), which makes evaluations many times cheaper; its
  // parameters must then keep the values of `initial`.
  AcousticFrameModel(const std::vector<AcousticFrame>& frames, const SonarModel& sonar,
                     double absorption_db_per_m, std::vector<std::string> material_names,
                     const ParameterSet& initial, bool response_is_fixed);

  const std::vector<CatalogEntry>& catalog() const override { return catalog_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  int frame_index(int frame) const override { return frames_[frame].index; }
  int range_bins() const override { return sonar_.axes.range_bins; }
  int beams() const override { return sonar_.axes.beam_count(); }
  bool Counts(int frame, std::size_t pixel) const override {
    return frames_[frame].use.empty() || frames_[frame].use[pixel] != 0;
  }
  bool ShowsMaterial(int material) const override { return shown_[material]; }
  const std::vector<std::string>& material_names() const override { return material_names_; }
  bool Evaluate(int frame, const ParameterValues& values, std::span<const int> active, bool derivatives,
                PixelTerms& terms) const override;

  ParameterValues Values(const ParameterSet& parameters) const;
  // The parameters with these values, and what no catalog entry names as given at first.
  ParameterSet Parameters(const ParameterValues& values) const;

  // Mean power of a frame's pixels.
  std::vector<double> MeanPower(int frame, const ParameterValues& values) const;

 private:
  struct Means;
  Means MeansAt(int frame, const ParameterSet& parameters, std::span<const int> active) const;
  // What the weights of a response are: themselves, or their derivative by one of its widths.
  enum class Slope { kNone, kAzimuthWidth, kPulseLength };
  PowerResponse Response(const ParameterSet& parameters, const EchoPower& echoes, Slope of) const;
  ImageStack EchoImages(int frame, const ParameterSet& parameters, std::span<const int> curves) const;
  std::vector<double> ResponseSlope(int frame, const ParameterSet& parameters, Slope of) const;

  const std::vector<AcousticFrame>& frames_;
  SonarModel sonar_;
  double absorption_db_per_m_;
  std::vector<std::string> material_names_;
  ParameterSet initial_;
  std::vector<CatalogEntry> catalog_;
  std::vector<bool> shown_;
  std::vector<PixelEchoes> pixel_echoes_;  // by frame; empty where the response is not fixed
};

}  // namespace sonarcal
