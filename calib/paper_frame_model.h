// The paper's model as a fit sees it: eta is the expected image, 0..1 of full scale, and the residual its
// difference to the recorded one; every pixel tells alike.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/frame_model.h"
#include "sim/expected_paper_image.h"

namespace sonarcal {

struct FitFrame {
  int index = 0;  // in the recording
  EchoHistogram echoes;
  std::vector<double> measured;  // range_bins x beams, 0..1 of full scale
  // 1 for the pixels that count; empty: all. For what the scene does not contain.
  std::vector<std::uint8_t> use = {};
};

class PaperFrameModel final : public FrameModel {
 public:
  // Frames, geometry and names must outlive the model. Throws DataError where a frame does not fit the
  // geometry, or a material of the scene has no parameters.
  PaperFrameModel(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
                  const std::vector<std::string>& material_names, const ParameterSet& initial);

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
  bool IsLikelihood() const override { return false; }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;

  ParameterValues Values(const ParameterSet& parameters) const;
  void Store(const ParameterValues& values, ParameterSet& parameters) const;

 private:
  template <typename T, typename ValueAt>
  PaperParameters<T> ParametersAt(const ValueAt& value_at) const;

  const std::vector<FitFrame>& frames_;
  const ImageGeometry& geometry_;
  const std::vector<std::string>& material_names_;
  PaperParameters<double> initial_;  // and what no catalog entry names
  std::vector<CatalogEntry> catalog_;
  std::vector<bool> shown_;
};

}  // namespace sonarcal
