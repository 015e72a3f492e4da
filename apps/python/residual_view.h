// A fit's residual and Jacobian at any parameters, frame by frame: for looking at, not for solving. The
// models are those of calib/, and so are the formulas.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/workflow/fit_frames.h"
#include "core/types/mask.h"

namespace sonarcal::python {

// Residuals of a frame at given values. Half the square of the acoustic model's residual is the negative
// log-likelihood of speckle. The residual of the paper's model is the difference expected - recorded
// in full scales; after WeighAbout it is that of calib/paper/paper_likelihood.h.
struct FrameResiduals {
  PolarImage expected;  // on the recording's grey scale
  PolarImage recorded;
  Grid<double> residual;         // range_bins x beams; 0 where a pixel does not count
  Mask counted;                  // pixels that a fit would count
  std::vector<double> jacobian;  // d residual / d value, range_bins x beams x names, in the parameters' units
  std::vector<std::string> names;
};

class ResidualView {
 public:
  // Traces the frames of these indices; empty: all. Throws DataError as FitRecording does.
  ResidualView(std::shared_ptr<const RecordingSource> recording, const Scene& scene, ParameterSet initial,
               std::vector<int> frames, const workflow::FitRecordingOptions& options);

  // Every parameter of the model, in the order of `values`.
  const std::vector<calib::CatalogEntry>& catalog() const;
  const calib::ParameterValues& initial_values() const { return initial_values_; }
  const std::vector<int>& frames() const { return frames_; }

  // `frame` is its index in the recording; derivatives are by `names`. Where beam, pulse or poses are moved
  // or asked for, the frames are traced again, as between the rounds of a fit. Throws DataError for values
  // at which the model has none. Not for two threads at once.
  FrameResiduals At(const calib::ParameterValues& values, int frame, const std::vector<std::string>& names);

  // Weighs the residuals of the paper's model from now on by the noise that the frames show about these
  // values, as does a fit that ends at these values. Throws DataError for the acoustic model, which knows its
  // noise.
  void WeighAbout(const calib::ParameterValues& values);

 private:
  const calib::FrameModel& model() const;
  void CheckCount(const calib::ParameterValues& values) const;
  std::vector<int> EntriesOf(const std::vector<std::string>& names) const;
  PolarImage Expected(int position, const calib::ParameterValues& values) const;

  std::shared_ptr<const RecordingSource> recording_;
  ParameterSet initial_;
  std::vector<int> frames_;
  std::unique_ptr<sim::Simulator> simulator_;
  std::optional<sim::ImageGeometry> geometry_;
  std::vector<sim::EchoHistogram> echoes_;  // paper, by frame of the recording
  std::vector<calib::FitFrame> paper_frames_;
  std::vector<calib::AcousticFrame> acoustic_frames_;
  std::unique_ptr<calib::PaperFrameModel> paper_;  // one of the two
  std::unique_ptr<calib::AcousticFrameModel> acoustic_;
  calib::ParameterValues initial_values_;
  calib::ParameterValues point_;  // acoustic: geometry is taken about it
  std::vector<int> geometric_;    // and differentiated by these
};

}  // namespace sonarcal::python
