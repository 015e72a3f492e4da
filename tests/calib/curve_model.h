// One backscatter curve, seen pixel by pixel at known incidence angles: SYNTHETIC exponential power about the
// curve plus noise, independent in every pixel. A fit of it takes milliseconds, so that hundreds of data sets
// can be fitted in a test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"
#include "core/types/parameters.h"

namespace sonarcal::testing {

struct CurveModelOptions {
  GsabParameters<double> truth;
  double noise = 1e-4;   // power
  int angles = 86;       // range bins: 0.5, 1.5, ... degrees
  int pixels = 32;       // beams: pixels at each angle from 20 degrees on
  int least_pixels = 2;  // at the smallest angle; the number grows linearly between the two
  int first_angle = 0;   // smaller angles are not measured
  std::uint64_t seed = 1;
};

struct CurvePixel {
  int angle = 0;       // 0.5 degrees, 1.5, ...
  double power = 0.0;  // 0: not measured
};

class CurveModel final : public calib::FrameModel {
 public:
  explicit CurveModel(const CurveModelOptions& options);

  const std::vector<calib::CatalogEntry>& catalog() const override { return catalog_; }
  int frame_count() const override { return 1; }
  int frame_index(int) const override { return 0; }
  int range_bins() const override { return options_.angles; }
  int beams() const override { return options_.pixels; }
  bool Counts(int, std::size_t pixel) const override { return recorded_[pixel].power > 0.0; }
  bool ShowsMaterial(int) const override { return true; }
  const std::vector<std::string>& material_names() const override { return names_; }
  bool IsLikelihood() const override { return true; }
  std::unique_ptr<calib::FrameEvaluation> At(int frame, const calib::ParameterValues& values,
                                             std::span<const int> active, Terms wanted) const override;

  // A, B, C, D, E and F.
  calib::ParameterValues truth() const;

 private:
  CurveModelOptions options_;
  std::vector<std::string> names_ = {"plate"};
  std::vector<calib::CatalogEntry> catalog_;
  std::vector<CurvePixel> recorded_;
};

}  // namespace sonarcal::testing
