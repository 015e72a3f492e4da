// A frame of the paper's model at one set of values: the sum of the echoes of each pixel before the clamp,
// its derivatives, and the residuals. Range and azimuth errors are those of the gathered echoes; curves and
// display are exact.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "calib/models/frame_model.h"
#include "calib/paper/paper_likelihood.h"
#include "sim/gathered/paper_echoes.h"
#include "sim/physics/paper_echo.h"

namespace sonarcal::calib {

// Image of the derivatives by an entry of the catalog.
struct PaperSlope {
  int entry = 0;
  std::vector<double> image;  // range_bins x beams
};

// Recorded data of a frame.
struct PaperRecord {
  std::span<const double> measured;   // range_bins x beams, 0..1 of full scale
  std::span<const std::uint8_t> use;  // 1 for used pixels; empty: all
  double level = 0.0;                 // one grey level as a fraction of full scale; 0: values are not rounded
};

// Echoes by incidence, kCurveStride values per coarse node and material: the echo without loss as a fraction
// of the display's span, its derivatives by A to F, and the derivative by the source level.
std::vector<double> TabulateEchoes(const sim::PaperParameters<double>& parameters);
// Appends those of one curve.
void AppendEchoes(const sim::PaperParameters<double>& parameters, const GsabParameters<double>& curve,
                  std::vector<double>& table);

class PaperEvaluation final : public FrameEvaluation {
 public:
  // Catalog, recorded data and likelihood must outlive the evaluation. `table`: by TabulateEchoes, because
  // all frames share it. `likelihood`: null for the difference of the clamped image from the recorded one.
  // `slopes`: of the active entries of range and azimuth errors.
  PaperEvaluation(const std::vector<CatalogEntry>& catalog, const sim::PaperParameters<double>& parameters,
                  std::shared_ptr<const std::vector<double>> table,
                  std::shared_ptr<const sim::PaperEchoes> echoes, const PaperRecord& recorded, int beams,
                  const PaperLikelihood* likelihood, std::span<const int> active,
                  std::vector<PaperSlope> slopes, FrameModel::Terms wanted);

  bool Bins(int first, int last, PixelTerms& terms) const override;

  // Sums of all pixels, used or not.
  std::vector<double> Sums() const;

 private:
  // Kind of a Jacobian column.
  enum class Of { kCurve, kSourceLevel, kDisplayMin, kDisplayMax, kSlope };
  struct Column {
    Of of = Of::kCurve;
    std::size_t index = 0;  // of a curve: among the sums of a pixel
    std::size_t slope = 0;
  };
  static Column PlanColumn(const CatalogEntry& entry);
  // Consecutive pixels that show an echo. The sum of the others is 0, whatever curves and display.
  struct Lit {
    std::span<const std::uint32_t> pixels;
    std::span<const double> sums;   // pixels x materials x kCurveStride
    std::span<const double> total;  // per pixel
  };
  // Calls body(lit) for all of these pixels that show an echo, some at a time.
  template <typename Body>
  void ForLit(std::size_t first, std::size_t last, const Body& body) const;
  // Derivative by the parameter of a column that is not of a curve.
  double Derivative(const Column& column, std::size_t pixel, const double* sums, double total) const;
  void Residuals(std::span<const double> total, std::span<const double> recorded,
                 std::span<PaperResidual> residuals) const;

  std::shared_ptr<const sim::PaperEchoes> echoes_;
  PaperRecord recorded_;
  std::size_t beams_;
  const PaperLikelihood* likelihood_;
  std::vector<PaperSlope> slopes_;
  FrameModel::Terms wanted_;
  std::size_t materials_;
  double span_db_;
  std::shared_ptr<const std::vector<double>> table_;
  std::vector<Column> columns_;
  std::vector<std::size_t> not_of_curves_;  // indices of columns
};

}  // namespace sonarcal::calib
