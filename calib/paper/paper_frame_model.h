// The paper's model for a fit. eta is the sum of a pixel's echoes before clamping, as a fraction of full
// scale. Until the noise is known, the residual is the clamped image minus the recorded one. With known noise
// it is that of calib/paper/paper_likelihood.h, and priors can be weighed against it.
//
// Exact gauges: SL - NL + AG - dB_min (with dB_max moving along) and a common factor on A, C and E of all
// materials are one number. The two Gaussians of a curve may be exchanged. Only transmission loss determines
// the span dB_max - dB_min: if 2 TL hardly varies over the echoes, span and curves (in dB above dB_min) may
// grow by a common factor. So bounds and priors apply to quantities that no gauge changes: the level of an
// echo 1 m from the sonar above dB_min, and the span.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"
#include "calib/paper/paper_evaluation.h"
#include "calib/paper/paper_likelihood.h"
#include "sim/paper/expected_paper_image.h"

namespace sonarcal::calib {

struct FitFrame {
  int index = 0;  // index in the recording
  sim::EchoHistogram echoes;
  std::vector<double> measured;  // range_bins x beams, 0..1 of full scale
  // 1 for used pixels; empty: all. Excludes objects that the scene does not contain.
  std::vector<std::uint8_t> use = {};
  double level = 0.0;  // one grey level as a fraction of full scale; 0: values are not rounded
};

// Shares of the pixels that show an echo, over all frames of a model.
struct PaperClipping {
  double modelled = 0.0;  // at full scale in the model
  double recorded = 0.0;  // at full scale in the recording
};

class PaperFrameModel : public FrameModel {
 public:
  // Frames, geometry and names must outlive the model. Throws DataError if a frame does not fit the geometry
  // or if a material of the scene has no parameters.
  PaperFrameModel(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                  const std::vector<std::string>& material_names, const ParameterSet& initial);
  // Refused: the frames would be gone.
  PaperFrameModel(std::vector<FitFrame>&& frames, const sim::ImageGeometry& geometry,
                  const std::vector<std::string>& material_names, const ParameterSet& initial) = delete;

  const std::vector<CatalogEntry>& catalog() const override { return catalog_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  int frame_index(int frame) const override { return frames_[frame].index; }
  int range_bins() const override { return geometry_.axes.range_bins; }
  int beams() const override { return geometry_.axes.beam_count(); }
  bool Counts(int frame, std::size_t pixel) const override {
    return frames_[frame].use.empty() || frames_[frame].use[pixel] != 0;
  }
  bool ShowsMaterial(int material) const override { return shown_[material]; }
  const std::vector<std::string>& material_names() const override { return material_names_; }
  bool IsLikelihood() const override { return likelihood_.has_value(); }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;
  std::unique_ptr<FrameModel> Coarse(std::size_t wanted_pixels) const override;
  // Null while the noise is unknown.
  std::unique_ptr<OneCurveModel> OfCurve(int material, const ParameterValues& values) const override;

  // Returns the same frames in blocks of pixels: a tenth of the work, with nearly all the information on
  // curves and display. The result owns its frames. Its noise is that of block means. Null if the image
  // cannot be divided.
  std::unique_ptr<PaperFrameModel> InBlocks() const;

  ParameterValues Values(const ParameterSet& parameters) const;
  void Store(const ParameterValues& values, ParameterSet& parameters) const;

  // Sets the noise. From then on residuals are in units of it.
  void SetNoise(const PaperNoise& noise) { likelihood_.emplace(noise); }
  const PaperNoise& noise() const { return likelihood_.value().noise(); }
  // Noise that the frames show about these values.
  PaperNoise NoiseAbout(const ParameterValues& values) const;
  PaperClipping ClippingAt(const ParameterValues& values) const;
  // RMS difference of the two images, as a fraction of full scale, over the pixels that show an echo in
  // either.
  double RmsDifference(const ParameterValues& a, const ParameterValues& b) const;

 private:
  // SNR - dB_min of an echo of GSAB = 1, 1 m from the sonar, without absorption.
  double LevelOfOneDb() const {
    return initial_.source_level_db - initial_.noise_level_db + initial_.array_gain_db -
           initial_.display.db_min;
  }
  // Echoes of a frame through these errors, gathered or kept from the last call.
  std::shared_ptr<const sim::PaperEchoes> EchoesOf(int frame, const JitterParameters<double>& errors) const;
  // Table of the curves at these values, kept from the last call.
  std::shared_ptr<const std::vector<double>> TableOf(const sim::PaperParameters<double>& parameters) const;
  // Derivatives of a frame by the active sizes of range and azimuth errors.
  std::vector<PaperSlope> ErrorSlopes(int frame, const ParameterValues& values,
                                      std::span<const int> active) const;
  std::unique_ptr<PaperEvaluation> EvaluationAt(int frame, const sim::PaperParameters<double>& parameters,
                                                std::span<const int> active, std::vector<PaperSlope> slopes,
                                                Terms wanted) const;
  void BoundByLevel();
  void AddPriors();
  // Calls body(frame, pixel, sum, recorded) for every used pixel.
  template <typename Body>
  void ForPixels(const ParameterValues& values, const Body& body) const;
  template <typename T, typename ValueAt>
  sim::PaperParameters<T> ParametersAt(const ValueAt& value_at) const;

  const std::vector<FitFrame>& frames_;
  const sim::ImageGeometry& geometry_;
  const std::vector<std::string>& material_names_;
  ParameterSet given_;
  sim::PaperParameters<double> initial_;  // also holds parameters without a catalog entry
  std::vector<CatalogEntry> catalog_;
  std::vector<bool> shown_;
  std::optional<PaperLikelihood> likelihood_;
  // Gathered echoes of the frames, and the last table.
  struct Gathered {
    struct Frame {
      JitterParameters<double> errors = {};
      std::shared_ptr<const sim::PaperEchoes> echoes;
    };
    std::mutex mutex;
    std::vector<Frame> frames;
    std::size_t bytes = 0;
    sim::PaperParameters<double> of_table;
    std::shared_ptr<const std::vector<double>> table;
  };
  mutable Gathered gathered_;
};

}  // namespace sonarcal::calib
