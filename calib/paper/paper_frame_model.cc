#include "calib/paper/paper_frame_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "calib/models/one_curve_model.h"
#include "calib/paper/coarse_paper.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/paper/expected_paper_image.h"
#include "sim/paper/paper_values.h"

namespace sonarcal::calib {
namespace {

// Max number of parameters of range and azimuth errors.
constexpr int kErrorParameters = 3;
using Dual = ceres::Jet<double, kErrorParameters>;

// Memory for the gathered echoes of all frames of a model. Those of more frames are gathered each time.
constexpr std::size_t kMaxKeptBytes = std::size_t{512} << 20;

std::size_t BytesOf(const sim::PaperEchoes* echoes) {
  if (echoes == nullptr) return 0;
  return echoes->nodes.entries.size() * sizeof(sim::PixelEchoes::Entry) +
         echoes->nodes.start.size() * sizeof(std::uint32_t) + echoes->loss_db.size() * sizeof(float);
}

// Recorded values of pixels that show one material.
class GreyLaw final : public PixelLaw {
 public:
  GreyLaw(const PaperLikelihood& likelihood, sim::PaperParameters<double> parameters)
      : likelihood_(likelihood), parameters_(std::move(parameters)) {}

  void Add(double measured, double level) {
    measured_.push_back(measured);
    level_.push_back(level);
  }

  std::vector<double> Table(const GsabParameters<double>& curve) const override {
    std::vector<double> table;
    AppendEchoes(parameters_, curve, table);
    return table;
  }

  bool Judge(std::size_t first, std::span<const double> mean, PixelTerms& terms) const override {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const auto [residual, slope] = likelihood_.Residual(mean[i], measured_[first + i], level_[first + i]);
      terms.residual[i] = residual;
      terms.slope[i] = slope;
      terms.information[i] = slope * slope;
    }
    return true;
  }

 private:
  PaperLikelihood likelihood_;
  sim::PaperParameters<double> parameters_;
  std::vector<double> measured_;
  std::vector<double> level_;
};

// Default limits: range and azimuth errors wider than this many bins and beams are not plausible.
constexpr double kMaxErrorBins = 3.0;
constexpr double kMaxErrorBeams = 6.0;

}  // namespace

PaperFrameModel::PaperFrameModel(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                                 const std::vector<std::string>& material_names, const ParameterSet& initial)
    : frames_(frames),
      geometry_(geometry),
      material_names_(material_names),
      given_(initial),
      initial_(sim::PaperParametersFor(initial, material_names)),
      catalog_(BuildCatalog(material_names)),
      shown_(material_names.size(), false) {
  gathered_.frames.resize(frames.size());
  for (const FitFrame& frame : frames) {
    if ((!frame.use.empty() && frame.use.size() != pixel_count()) || frame.measured.size() != pixel_count() ||
        frame.echoes.materials != static_cast<int>(material_names.size())) {
      throw DataError("fit: frame {} has {} pixels and {} materials, expected {} and {}", frame.index,
                      frame.measured.size(), frame.echoes.materials, pixel_count(), material_names.size());
    }
    for (const sim::EchoHistogram::Entry& entry : frame.echoes.entries) {
      if (entry.weight > 0.0F) shown_[entry.node / sim::kIncidenceNodes] = true;
    }
  }
  const double beam_deg = DegFromRad((geometry.beam_edges_rad.back() - geometry.beam_edges_rad.front()) /
                                     geometry.axes.beam_count());
  for (CatalogEntry& entry : catalog_) {
    if (entry.name == "jitter.sigma_range_m") entry.upper = kMaxErrorBins * geometry.axes.range_bin_m();
    if (entry.name == "jitter.sigma_azimuth_deg") entry.upper = kMaxErrorBeams * beam_deg;
  }
  BoundByLevel();
  AddPriors();
}

// Sets bounds of curves and display, for quantities that do not depend on the gauge.
void PaperFrameModel::BoundByLevel() {
  // Level of an echo 1 m from the sonar: min above dB_min, and max above the given dB_max. The paper's own is
  // 70 dB above dB_min and 67 dB above dB_max.
  constexpr double kLowestAboveMinDb = -20.0;
  constexpr double kHighestAboveMaxDb = 77.0;
  // Span of the display: min a third of the paper's own; max as in the paper's example, 0 to 100 dB.
  constexpr double kNarrowestDb = 1.0;
  constexpr double kWidestDb = 100.0;
  // Beyond these, a wide Gaussian and a flat cosine are the same curve.
  constexpr double kFlattestD = 0.3;
  constexpr double kSteepestD = 3.0;
  constexpr double kWidestFDeg = 30.0;
  const double level_db = LevelOfOneDb();
  const double highest_db = kHighestAboveMaxDb + initial_.display.db_max - initial_.display.db_min;
  for (CatalogEntry& entry : catalog_) {
    if (IsAmplitude(entry)) {
      entry.lower = PowerFromDb(kLowestAboveMinDb - level_db);
      entry.upper = PowerFromDb(highest_db - level_db);
    } else if (entry.group == ParameterGroup::kGsab) {
      NarrowToRealCurves(entry);
      if (entry.index == 3) {
        entry.lower = kFlattestD;
        entry.upper = kSteepestD;
      } else if (entry.index == 5) {
        entry.upper = kWidestFDeg;
      }
    } else if (entry.name == "display.db_max") {
      entry.lower = initial_.display.db_min + kNarrowestDb;
      entry.upper = initial_.display.db_min + kWidestDb;
    }
  }
}

// Centres the priors on the paper's own curve for every start, so that the best fit does not depend on the
// start. Parameters that the frames do not determine stay there and are reported as not determined.
void PaperFrameModel::AddPriors() {
  constexpr double kStepsOfLevel = 2.0;  // 20 dB, because the user sets the gauge
  const GsabParameters<double> paper;
  const std::array<double, 6> values = {paper.a, paper.b_deg, paper.c, paper.d, paper.e, paper.f_deg};
  const double gauge = PowerFromDb(sim::kPaperBlackBelowSourceDb - LevelOfOneDb());
  for (CatalogEntry& entry : catalog_) {
    if (entry.group != ParameterGroup::kGsab) continue;
    const bool amplitude = IsAmplitude(entry);
    const double value = values[entry.index] * (amplitude ? gauge : 1.0);
    entry.prior = Prior{.coordinate = entry.CoordinateFromValue(value),
                        .sigma = entry.typical_step * (amplitude ? kStepsOfLevel : 1.0)};
  }
}

namespace {

class PaperModelOfBlocks final : private CoarsePaperFrames, public PaperFrameModel {
 public:
  PaperModelOfBlocks(CoarsePaperFrames of, const std::vector<std::string>& material_names,
                     const ParameterSet& initial)
      : CoarsePaperFrames(std::move(of)), PaperFrameModel(frames, geometry, material_names, initial) {}
};

}  // namespace

std::unique_ptr<PaperFrameModel> PaperFrameModel::InBlocks() const {
  CoarsePaperFrames coarse = MakeCoarse(frames_, geometry_);
  const double pixels_a_block =
      static_cast<double>(pixel_count()) / (static_cast<double>(coarse.geometry.axes.range_bins) *
                                            static_cast<double>(coarse.geometry.axes.beam_count()));
  if (pixels_a_block <= 1.0) return nullptr;
  auto model = std::make_unique<PaperModelOfBlocks>(std::move(coarse), material_names_, given_);
  if (likelihood_) {
    PaperNoise noise = likelihood_->noise();
    noise.sigma /= std::sqrt(pixels_a_block);
    noise.knee_sigma /= std::sqrt(pixels_a_block);
    model->SetNoise(noise);
  }
  return model;
}

std::unique_ptr<OneCurveModel> PaperFrameModel::OfCurve(int material, const ParameterValues& values) const {
  if (!likelihood_) return nullptr;
  const sim::PaperParameters<double> parameters =
      ParametersAt<double>([&](int entry) { return values[entry]; });
  const std::shared_ptr<const std::vector<double>> table = TableOf(parameters);
  OneCurvePixels pixels;
  auto law = std::make_unique<GreyLaw>(*likelihood_, parameters);
  for (int frame = 0; frame < frame_count(); ++frame) {
    const FitFrame& of = frames_[frame];
    const std::vector<double> sums = EvaluationAt(frame, parameters, {}, {}, Terms::kResiduals)->Sums();
    const std::shared_ptr<const sim::PaperEchoes> echoes = EchoesOf(frame, parameters.jitter);
    for (std::size_t pixel = 0; pixel < sums.size(); ++pixel) {
      if (!Counts(frame, pixel)) continue;
      if (pixels.Add(echoes->nodes, pixel, material, 1.0, *table, sums[pixel]))
        law->Add(of.measured[pixel], of.level);
    }
  }
  return std::make_unique<OneCurveModel>(*this, material, std::move(pixels), std::move(law));
}

std::unique_ptr<FrameModel> PaperFrameModel::Coarse(std::size_t /*wanted_pixels*/) const {
  return InBlocks();
}

template <typename Body>
void PaperFrameModel::ForPixels(const ParameterValues& values, const Body& body) const {
  const sim::PaperParameters<double> parameters =
      ParametersAt<double>([&](int entry) { return values[entry]; });
  for (int frame = 0; frame < frame_count(); ++frame) {
    const FitFrame& of = frames_[frame];
    const std::vector<double> sums = EvaluationAt(frame, parameters, {}, {}, Terms::kResiduals)->Sums();
    for (std::size_t i = 0; i < of.measured.size(); ++i) {
      if (Counts(frame, i)) body(of, sums[i], of.measured[i]);
    }
  }
}

PaperNoise PaperFrameModel::NoiseAbout(const ParameterValues& values) const {
  // Ranges of bright pixels, which determine the knee, as fractions of full scale, and of faint pixels, in
  // grey levels.
  constexpr double kBrightLow = 0.25;
  constexpr double kBrightHigh = 0.9;
  constexpr double kFaintLow = 2.0;
  constexpr double kFaintHigh = 60.0;
  struct Sums {
    double square = 0.0;
    double of = 0.0;
    double ratio() const { return of > 0.0 ? square / of : 0.0; }
  };
  Sums all;
  Sums bright;
  Sums faint;
  double level = 0.0;
  ForPixels(values, [&](const FitFrame& frame, double sum, double recorded) {
    const double shown = std::clamp(sum, 0.0, 1.0);
    const double square = (recorded - shown) * (recorded - shown);
    level = std::max(level, frame.level);
    if (recorded > 0.0 || shown > 0.5 * frame.level) {
      all.square += square;
      all.of += 1.0;
    }
    if (sum > kBrightLow && sum < kBrightHigh) {
      bright.square += square;
      bright.of += sum;
    }
    if (frame.level > 0.0 && sum > kFaintLow * frame.level && sum < kFaintHigh * frame.level) {
      const double rounding = frame.level * frame.level / 12.0;
      faint.square += (square - rounding) / frame.level;
      faint.of += sum;
    }
  });
  const double least = level > 0.0 ? 0.3 * level : 1e-4;  // rounding has a standard deviation of 0.29 levels
  PaperNoise noise;
  noise.sigma = std::max(least, std::sqrt(all.ratio()));
  noise.knee_sigma = std::max(least, std::sqrt(bright.ratio()));
  noise.variance_levels = std::max(0.0, faint.ratio());
  return noise;
}

double PaperFrameModel::RmsDifference(const ParameterValues& a, const ParameterValues& b) const {
  std::vector<double> first;
  ForPixels(a, [&](const FitFrame&, double sum, double) { first.push_back(std::clamp(sum, 0.0, 1.0)); });
  double square = 0.0;
  double lit = 0.0;
  std::size_t i = 0;
  ForPixels(b, [&](const FitFrame&, double sum, double) {
    const double second = std::clamp(sum, 0.0, 1.0);
    if (first[i] > 0.0 || second > 0.0) lit += 1.0;
    square += (first[i] - second) * (first[i] - second);
    ++i;
  });
  return std::sqrt(square / std::max(1.0, lit));
}

PaperClipping PaperFrameModel::ClippingAt(const ParameterValues& values) const {
  double echoes = 0.0;
  PaperClipping clipping;
  ForPixels(values, [&](const FitFrame& frame, double sum, double recorded) {
    const double half = 0.5 * frame.level;
    if (!(sum > half)) return;
    echoes += 1.0;
    if (sum >= 1.0 - half) clipping.modelled += 1.0;
    if (recorded >= 1.0 - half) clipping.recorded += 1.0;
  });
  clipping.modelled /= std::max(1.0, echoes);
  clipping.recorded /= std::max(1.0, echoes);
  return clipping;
}

ParameterValues PaperFrameModel::Values(const ParameterSet& parameters) const {
  sim::PaperParameters<double> paper = sim::PaperParametersFor(parameters, material_names_);
  ParameterValues values;
  for (const CatalogEntry& entry : catalog_) values.push_back(PaperSlot(paper, entry));
  return values;
}

void PaperFrameModel::Store(const ParameterValues& values, ParameterSet& parameters) const {
  StorePaperParameters(ParametersAt<double>([&](int entry) { return values[entry]; }), material_names_,
                       parameters);
}

template <typename T, typename ValueAt>
sim::PaperParameters<T> PaperFrameModel::ParametersAt(const ValueAt& value_at) const {
  sim::PaperParameters<T> parameters = CastPaperParameters<T>(initial_);
  for (std::size_t entry = 0; entry < catalog_.size(); ++entry) {
    PaperSlot(parameters, catalog_[entry]) = value_at(static_cast<int>(entry));
  }
  return parameters;
}

std::shared_ptr<const sim::PaperEchoes> PaperFrameModel::EchoesOf(
    int frame, const JitterParameters<double>& errors) const {
  Gathered::Frame& kept = gathered_.frames[frame];
  {
    const std::lock_guard lock(gathered_.mutex);
    if (kept.echoes != nullptr && kept.errors == errors) return kept.echoes;
  }
  // Without the lock: its threads may take up another frame meanwhile.
  auto echoes = std::make_shared<const sim::PaperEchoes>(
      sim::GatherPaperEchoes(frames_[frame].echoes, geometry_, errors));
  const std::lock_guard lock(gathered_.mutex);
  gathered_.bytes -= BytesOf(kept.echoes.get());
  kept = {};
  if (gathered_.bytes + BytesOf(echoes.get()) > kMaxKeptBytes) return echoes;
  gathered_.bytes += BytesOf(echoes.get());
  kept = {.errors = errors, .echoes = echoes};
  return echoes;
}

std::shared_ptr<const std::vector<double>> PaperFrameModel::TableOf(
    const sim::PaperParameters<double>& parameters) const {
  const std::lock_guard lock(gathered_.mutex);
  if (gathered_.table == nullptr || parameters != gathered_.of_table) {
    gathered_.table = std::make_shared<const std::vector<double>>(TabulateEchoes(parameters));
    gathered_.of_table = parameters;
  }
  return gathered_.table;
}

std::vector<PaperSlope> PaperFrameModel::ErrorSlopes(int frame, const ParameterValues& values,
                                                     std::span<const int> active) const {
  std::vector<PaperSlope> slopes;
  for (const int entry : active) {
    if (catalog_[entry].group == ParameterGroup::kJitter) slopes.push_back({.entry = entry, .image = {}});
  }
  if (slopes.empty()) return slopes;
  SONARCAL_CHECK(slopes.size() <= kErrorParameters, "{} parameters of errors", slopes.size());
  const sim::PaperImageEvaluation image(frames_[frame].echoes, geometry_,
                                        ParametersAt<double>([&](int entry) { return values[entry]; }));
  auto images = image.Derivatives(ParametersAt<Dual>([&](int entry) {
    const auto slope = std::ranges::find(slopes, entry, &PaperSlope::entry);
    return slope == slopes.end() ? Dual(values[entry])
                                 : Dual(values[entry], static_cast<int>(slope - slopes.begin()));
  }));
  for (std::size_t k = 0; k < slopes.size(); ++k) slopes[k].image = std::move(images[k]);
  return slopes;
}

std::unique_ptr<PaperEvaluation> PaperFrameModel::EvaluationAt(int frame,
                                                               const sim::PaperParameters<double>& parameters,
                                                               std::span<const int> active,
                                                               std::vector<PaperSlope> slopes,
                                                               Terms wanted) const {
  const FitFrame& of = frames_[frame];
  return std::make_unique<PaperEvaluation>(
      catalog_, parameters, TableOf(parameters), EchoesOf(frame, parameters.jitter),
      PaperRecord{.measured = of.measured, .use = of.use, .level = of.level}, beams(),
      likelihood_ ? &*likelihood_ : nullptr, active, std::move(slopes), wanted);
}

std::unique_ptr<FrameEvaluation> PaperFrameModel::At(int frame, const ParameterValues& values,
                                                     std::span<const int> active, Terms wanted) const {
  const sim::PaperParameters<double> parameters =
      ParametersAt<double>([&](int entry) { return values[entry]; });
  if (!(parameters.display.db_max > parameters.display.db_min)) return nullptr;
  std::vector<PaperSlope> slopes;
  if (wanted != Terms::kResiduals) slopes = ErrorSlopes(frame, values, active);
  return EvaluationAt(frame, parameters, active, std::move(slopes), wanted);
}

}  // namespace sonarcal::calib
