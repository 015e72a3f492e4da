// Frames of an acoustic fit in blocks of neighbouring pixels, for the search of start values.
//
// The number of looks of a block's mean power is multiplied by its number of pixels. Blocks have nearly all
// the information of the single pixels on curves and receiver, at a cost divided by the block size. A small
// sample of the pixels would not do: its best curves can be far from those of all pixels.
//
// Approximations: noise and gain of a block are those of its centre, speckle is independent within a block,
// and a clipped pixel has the power at which it was clipped. Geometry stays at the point of the fine model.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "calib/models/acoustic_evaluation.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/models/frame_model.h"
#include "calib/models/one_curve_model.h"

namespace sonarcal::calib {

// Size of a block in pixels.
struct PixelBlock {
  int bins = 1;
  int beams = 1;
};

// Axes of blocks. The last block of a row or column may reach beyond the image.
PolarAxes CoarseAxes(const PolarAxes& fine, const PixelBlock& block);

// Taper per beam, averaged in power.
std::vector<double> CoarseTaper(const std::vector<double>& fine, int beams_at_once);

class CoarseFrameModel final : public FrameModel {
 public:
  // The fine model must outlive this one and must not change.
  // `sonar` and `echoes`, per frame, are those of the fine model at the point of interest, without slopes.
  CoarseFrameModel(const AcousticFrameModel& fine, const SonarModel& sonar,
                   const std::vector<FrameEchoes>& echoes, const PixelBlock& block);

  const std::vector<CatalogEntry>& catalog() const override { return fine_.catalog(); }
  int frame_count() const override { return fine_.frame_count(); }
  int frame_index(int frame) const override { return fine_.frame_index(frame); }
  int range_bins() const override { return sonar_.axes.range_bins; }
  int beams() const override { return sonar_.axes.beam_count(); }
  bool Counts(int frame, std::size_t pixel) const override { return frames_[frame].use[pixel] != 0; }
  bool ShowsMaterial(int material) const override { return fine_.ShowsMaterial(material); }
  bool ShowsMirror(int material) const override { return fine_.ShowsMirror(material); }
  const std::vector<std::string>& material_names() const override { return fine_.material_names(); }
  int first_of_pose(int frame) const override { return fine_.first_of_pose(frame); }
  bool IsLikelihood() const override { return true; }
  std::unique_ptr<FrameEvaluation> At(int frame, const ParameterValues& values, std::span<const int> active,
                                      Terms wanted) const override;
  // Null if there are ghosts: they show materials by way of others.
  std::unique_ptr<OneCurveModel> OfCurve(int material, const ParameterValues& values) const override;

 private:
  struct CoarseFrame {
    FrameEchoes echoes;
    std::vector<RecordedPower> power;
    std::vector<std::uint8_t> use;
    std::vector<float> weight;
  };
  std::unique_ptr<AcousticEvaluation> Evaluation(int frame, const ParameterValues& values,
                                                 std::span<const int> active, Terms wanted) const;
  CoarseFrame Gather(int frame, const FrameEchoes& fine) const;
  // Echoes of the used pixels of each block, node by node, as a mean over those pixels.
  sim::PixelEchoes BlockEchoes(int frame, const sim::PixelEchoes& fine) const;

  // Calls act(for_pixels) for each block in order. for_pixels(visit) calls visit(bin, pixel) for each fine
  // pixel of the block.
  template <typename Act>
  void ForBlocks(const Act& act) const {
    for (int first_bin = 0; first_bin < fine_.range_bins(); first_bin += block_.bins) {
      for (int first_beam = 0; first_beam < fine_.beams(); first_beam += block_.beams) {
        act([&](const auto& visit) {
          for (int bin = first_bin; bin < std::min(first_bin + block_.bins, fine_.range_bins()); ++bin) {
            for (int beam = first_beam; beam < std::min(first_beam + block_.beams, fine_.beams()); ++beam)
              visit(bin, static_cast<std::size_t>(bin) * fine_.beams() + beam);
          }
        });
      }
    }
  }

  double PixelsOfBlock() const { return static_cast<double>(block_.bins) * block_.beams; }

  const AcousticFrameModel& fine_;
  PixelBlock block_;
  SonarModel sonar_;
  // per fine bin: its time-varied gain over that of the centre of its block
  std::vector<double> gain_of_centre_;
  std::vector<CoarseFrame> frames_;
};

}  // namespace sonarcal::calib
