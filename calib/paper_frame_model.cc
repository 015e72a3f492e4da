#include "calib/paper_frame_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

// Derivatives carried at once through the shading of cells.
constexpr int kStride = 8;
using Dual = ceres::Jet<double, kStride>;

// The blur ties a frame's pixels together, so all are computed at once and handed out run by run.
class WholeFrame final : public FrameEvaluation {
 public:
  WholeFrame(PixelTerms terms, std::size_t pixels_per_bin, std::size_t columns)
      : terms_(std::move(terms)), pixels_per_bin_(pixels_per_bin), columns_(columns) {}

  bool Bins(int first, int last, PixelTerms& terms) const override {
    const auto copy = [&](const std::vector<double>& from, std::size_t per_pixel, std::vector<double>& to) {
      const std::size_t stride = from.empty() ? 0 : pixels_per_bin_ * per_pixel;
      to.assign(from.begin() + static_cast<std::ptrdiff_t>(first * stride),
                from.begin() + static_cast<std::ptrdiff_t>(last * stride));
    };
    copy(terms_.residual, 1, terms.residual);
    copy(terms_.slope, 1, terms.slope);
    copy(terms_.information, 1, terms.information);
    copy(terms_.eta_jacobian, columns_, terms.eta_jacobian);
    return true;
  }

 private:
  PixelTerms terms_;
  std::size_t pixels_per_bin_;
  std::size_t columns_;
};

// Errors wider than this many bins and beams are no errors of a ray any more; a configuration may say
// otherwise.
constexpr double kMostBins = 6.0;
constexpr double kMostBeams = 10.0;

}  // namespace

PaperFrameModel::PaperFrameModel(const std::vector<FitFrame>& frames, const ImageGeometry& geometry,
                                 const std::vector<std::string>& material_names, const ParameterSet& initial)
    : frames_(frames),
      geometry_(geometry),
      material_names_(material_names),
      initial_(PaperParametersFor(initial, material_names)),
      catalog_(BuildCatalog(material_names)),
      shown_(material_names.size(), false) {
  for (const FitFrame& frame : frames) {
    if ((!frame.use.empty() && frame.use.size() != pixel_count()) || frame.measured.size() != pixel_count() ||
        frame.echoes.materials != static_cast<int>(material_names.size())) {
      throw DataError("fit: frame {} has {} pixels and {} materials, expected {} and {}", frame.index,
                      frame.measured.size(), frame.echoes.materials, pixel_count(), material_names.size());
    }
    for (const EchoHistogram::Entry& entry : frame.echoes.entries) {
      if (entry.weight > 0.0F) shown_[entry.node / kIncidenceNodes] = true;
    }
  }
  const double beam_deg = DegFromRad((geometry.beam_edges_rad.back() - geometry.beam_edges_rad.front()) /
                                     geometry.axes.beam_count());
  for (CatalogEntry& entry : catalog_) {
    if (entry.name == "jitter.sigma_range_m") entry.upper = kMostBins * geometry.axes.range_bin_m();
    if (entry.name == "jitter.sigma_azimuth_deg") entry.upper = kMostBeams * beam_deg;
  }
}

ParameterValues PaperFrameModel::Values(const ParameterSet& parameters) const {
  PaperParameters<double> paper = PaperParametersFor(parameters, material_names_);
  ParameterValues values;
  for (const CatalogEntry& entry : catalog_) values.push_back(PaperSlot(paper, entry));
  return values;
}

void PaperFrameModel::Store(const ParameterValues& values, ParameterSet& parameters) const {
  StorePaperParameters(ParametersAt<double>([&](int entry) { return values[entry]; }), material_names_,
                       parameters);
}

template <typename T, typename ValueAt>
PaperParameters<T> PaperFrameModel::ParametersAt(const ValueAt& value_at) const {
  PaperParameters<T> parameters = CastPaperParameters<T>(initial_);
  for (std::size_t entry = 0; entry < catalog_.size(); ++entry) {
    PaperSlot(parameters, catalog_[entry]) = value_at(static_cast<int>(entry));
  }
  return parameters;
}

// Derivatives are those of the forward model in dual numbers; Ceres' own wrapper would carry them through the
// blur pixel by pixel, which is ten times the work.
std::unique_ptr<FrameEvaluation> PaperFrameModel::At(int frame, const ParameterValues& values,
                                                     std::span<const int> active, Terms wanted) const {
  const FitFrame& of = frames_[frame];
  const PaperParameters<double> parameters = ParametersAt<double>([&](int entry) { return values[entry]; });
  if (!(parameters.display.db_max > parameters.display.db_min)) return nullptr;
  const PaperImageEvaluation evaluation(of.echoes, geometry_, parameters);
  const std::vector<double>& image = evaluation.image();
  const auto finish = [&](PixelTerms terms) {
    return std::make_unique<WholeFrame>(std::move(terms), beams(), active.size());
  };
  PixelTerms terms;
  terms.residual.resize(image.size());
  for (std::size_t i = 0; i < image.size(); ++i) {
    terms.residual[i] = Counts(frame, i) ? image[i] - of.measured[i] : 0.0;
  }
  if (wanted == Terms::kResiduals) return finish(std::move(terms));
  terms.slope.assign(image.size(), 1.0);
  terms.information.assign(image.size(), 1.0);
  const std::size_t count = active.size();
  terms.eta_jacobian.resize(image.size() * count);
  for (std::size_t first = 0; first < count; first += kStride) {
    const std::size_t columns = std::min<std::size_t>(kStride, count - first);
    std::vector<int> column_of(catalog_.size(), -1);
    for (std::size_t k = 0; k < columns; ++k) column_of[active[first + k]] = static_cast<int>(k);
    const auto images = evaluation.Derivatives(ParametersAt<Dual>([&](int entry) {
      return column_of[entry] < 0 ? Dual(values[entry]) : Dual(values[entry], column_of[entry]);
    }));
    for (std::size_t i = 0; i < image.size(); ++i) {
      const bool counts = Counts(frame, i);
      for (std::size_t k = 0; k < columns; ++k)
        terms.eta_jacobian[i * count + first + k] = counts ? images[k][i] : 0.0;
    }
  }
  return finish(std::move(terms));
}

}  // namespace sonarcal
