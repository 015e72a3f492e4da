#include "metrics/figures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/units.h"

namespace sonarcal::metrics {
namespace {

std::optional<double> Reciprocal(double value) {
  if (!(value > 0.0)) return std::nullopt;
  return 1.0 / value;
}

void AddOccupancy(std::vector<Figure>& figures) {
  const auto add = [&](const char* path, const char* label, Better better,
                       std::optional<double> (Occupancy::*of)() const) {
    figures.push_back(
        {.path = path, .label = label, .better = better, .averaged = [of](const ViewMetrics& view) {
           return (view.occupancy.*of)();
         }});
  };
  add("ns_over_nr", "Ns/Nr", Better::kNearOne, &Occupancy::ns_over_nr);
  add("na_over_ns", "Na/Ns", Better::kHigher, &Occupancy::na_over_ns);
  add("na_over_nr", "Na/Nr", Better::kHigher, &Occupancy::na_over_nr);
  add("iou", "IoU", Better::kHigher, &Occupancy::iou);
  add("dice", "Dice", Better::kHigher, &Occupancy::dice);
}

void AddOutline(std::vector<Figure>& figures) {
  const auto add = [&](const char* path, const char* label,
                       std::optional<double> (OutlineDistance::*of)() const) {
    figures.push_back({.path = path,
                       .label = label,
                       .unit = FigureUnit::kMetres,
                       .better = Better::kLower,
                       .polar_only = true,
                       .averaged = [of](const ViewMetrics& view) { return (view.outline.*of)(); }});
  };
  add("outline.mean_m", "distance of outlines, mean", &OutlineDistance::mean_m);
  add("outline.hausdorff_95_m", "distance of outlines, Hausdorff 95", &OutlineDistance::hausdorff_95_m);
}

void AddIntensity(std::vector<Figure>& figures, IntensityDomain domain) {
  const auto add = [&](const char* name, const char* label, FigureUnit unit, Better better,
                       Averaging averaging, std::optional<double> (*of)(const DifferenceSums&)) {
    figures.push_back(
        {.path = fmt::format("intensity.{}.{}", ToString(domain), name),
         .label = fmt::format("{}, {}", label, ToString(domain)),
         .unit = unit,
         .better = better,
         .averaging = averaging,
         .averaged = [domain, of](const ViewMetrics& view) { return of(view.intensity.Over(domain)); }});
  };
  using Sums = DifferenceSums;
  add("mean_absolute", "mean |difference|", FigureUnit::kFullScale, Better::kLower, Averaging::kPlain,
      [](const Sums& sums) { return sums.mean_absolute(); });
  add("rmse", "RMSE", FigureUnit::kFullScale, Better::kLower, Averaging::kRootMeanSquare,
      [](const Sums& sums) { return sums.mean_square(); });
  add("bias", "bias", FigureUnit::kFullScale, Better::kNearZero, Averaging::kPlain,
      [](const Sums& sums) { return sums.bias(); });
  add("relative", "relative error", FigureUnit::kNone, Better::kLower, Averaging::kPlain,
      [](const Sums& sums) { return sums.relative(); });
  add("psnr_db", "PSNR", FigureUnit::kDecibel, Better::kHigher, Averaging::kDecibelOfMeanSquare,
      [](const Sums& sums) { return sums.mean_square(); });
  add("ncc", "NCC", FigureUnit::kNone, Better::kHigher, Averaging::kPlain,
      [](const Sums& sums) { return sums.correlation(); });
}

void AddSsim(std::vector<Figure>& figures, const char* domain, SsimSum StructuralSimilarity::*sum) {
  figures.push_back({.path = fmt::format("intensity.{}.ssim", domain),
                     .label = fmt::format("SSIM, {}", domain),
                     .better = Better::kHigher,
                     .averaged = [sum](const ViewMetrics& view) { return (view.ssim.*sum).mean(); }});
}

void AddDistribution(std::vector<Figure>& figures, LevelDomain domain) {
  const auto add = [&](const char* name, const char* label, FigureUnit unit,
                       std::optional<double> LevelDistances::*of) {
    figures.push_back({.path = fmt::format("distribution.{}.{}", ToString(domain), name),
                       .label = fmt::format("{}, {}", label, ToString(domain)),
                       .unit = unit,
                       .better = Better::kLower,
                       .averaged = [domain, of](const ViewMetrics& view) {
                         return view.distribution[static_cast<std::size_t>(domain)].*of;
                       }});
  };
  add("l1_half", "histogram L1/2", FigureUnit::kNone, &LevelDistances::l1_half);
  add("wasserstein", "Wasserstein-1", FigureUnit::kFullScale, &LevelDistances::wasserstein);
  add("emd_db", "EMD", FigureUnit::kDecibel, &LevelDistances::emd_db);
  add("hellinger", "Hellinger", FigureUnit::kNone, &LevelDistances::hellinger);
  add("kolmogorov_smirnov", "Kolmogorov-Smirnov", FigureUnit::kNone, &LevelDistances::kolmogorov_smirnov);
  add("upper_anderson_darling", "upper-tail Anderson-Darling", FigureUnit::kNone,
      &LevelDistances::upper_anderson_darling);
}

void AddEchoes(std::vector<Figure>& figures) {
  const auto add = [&](const char* path, const char* label, Better better,
                       std::optional<double> (EchoCounts::*of)() const) {
    figures.push_back(
        {.path = path, .label = label, .better = better, .averaged = [of](const ViewMetrics& view) {
           return (view.echoes.*of)();
         }});
  };
  add("echoes.coverage_ratio", "echo coverage ratio", Better::kNearOne, &EchoCounts::coverage_ratio);
  add("echoes.matched_real", "matched echoes, real", Better::kHigher, &EchoCounts::matched_real);
  add("echoes.matched_simulated", "matched echoes, simulated", Better::kHigher,
      &EchoCounts::matched_simulated);
}

void AddTexture(std::vector<Figure>& figures, const char* domain, TextureCounts TextureMeasures::*counts) {
  figures.push_back(
      {.path = fmt::format("texture.{}.lbp_divergence", domain),
       .label = fmt::format("LBP texture, {}", domain),
       .better = Better::kLower,
       .averaged = [counts](const ViewMetrics& view) { return (view.texture.*counts).divergence(); }});
}

void AddSpeckle(std::vector<Figure>& figures, const char* region, SpeckleSums SpeckleMeasures::*real,
                SpeckleSums SpeckleMeasures::*simulated) {
  using Of = std::optional<double> (SpeckleSums::*)() const;
  const auto add = [&](const char* name, const char* label, FigureUnit unit, Averaging averaging, Of of) {
    for (const auto& [which, sums] : {std::pair{"real", real}, std::pair{"simulated", simulated}}) {
      figures.push_back(
          {.path = fmt::format("speckle.{}.{}.{}", region, which, name),
           .label = fmt::format("{}, {} {}", label, which, region),
           .unit = unit,
           .averaging = averaging,
           .polar_only = true,
           .averaged = [sums = sums, of](const ViewMetrics& view) { return ((view.speckle.*sums).*of)(); }});
    }
  };
  const auto add_ratio = [&](const char* name, const char* label, Of of) {
    figures.push_back({.path = fmt::format("speckle.{}.{}", region, name),
                       .label = fmt::format("{}, {}", label, region),
                       .better = Better::kNearOne,
                       .polar_only = true,
                       .averaged = [=](const ViewMetrics& view) -> std::optional<double> {
                         const std::optional<double> of_real = ((view.speckle.*real).*of)();
                         const std::optional<double> of_simulated = ((view.speckle.*simulated).*of)();
                         if (!of_real || !of_simulated || !(*of_real > 0.0)) return std::nullopt;
                         return *of_simulated / *of_real;
                       }});
  };
  add("scintillation_index", "scintillation index", FigureUnit::kNone, Averaging::kPlain,
      &SpeckleSums::scintillation_index);
  add("looks", "equivalent number of looks", FigureUnit::kNone, Averaging::kReciprocal,
      &SpeckleSums::scintillation_index);
  add("range_width_bins", "speckle width along range", FigureUnit::kBins, Averaging::kPlain,
      &SpeckleSums::range_width_bins);
  add("azimuth_width_beams", "speckle width along azimuth", FigureUnit::kBeams, Averaging::kPlain,
      &SpeckleSums::azimuth_width_beams);
  add_ratio("scintillation_ratio", "scintillation, simulated/real", &SpeckleSums::scintillation_index);
  add_ratio("range_width_ratio", "speckle width along range, simulated/real", &SpeckleSums::range_width_bins);
  add_ratio("azimuth_width_ratio", "speckle width along azimuth, simulated/real",
            &SpeckleSums::azimuth_width_beams);
}

std::vector<Figure> MakeFigures() {
  std::vector<Figure> figures;
  AddOccupancy(figures);
  for (const IntensityDomain domain :
       {IntensityDomain::kUnion, IntensityDomain::kWhole, IntensityDomain::kOverlap}) {
    AddIntensity(figures, domain);
  }
  AddSsim(figures, "union", &StructuralSimilarity::union_region);
  AddSsim(figures, "whole", &StructuralSimilarity::whole);
  figures.push_back(
      {.path = "intensity.object_mean_difference",
       .label = "difference of the objects' mean levels",
       .unit = FigureUnit::kFullScale,
       .better = Better::kLower,
       .averaged = [](const ViewMetrics& view) { return view.intensity.objects.mean_difference(); }});
  for (const LevelDomain domain : kLevelDomains) AddDistribution(figures, domain);
  AddEchoes(figures);
  AddTexture(figures, "union", &TextureMeasures::union_region);
  AddTexture(figures, "whole", &TextureMeasures::whole);
  AddSpeckle(figures, "background", &SpeckleMeasures::real_background,
             &SpeckleMeasures::simulated_background);
  AddSpeckle(figures, "object", &SpeckleMeasures::real_object, &SpeckleMeasures::simulated_object);
  AddOutline(figures);
  return figures;
}

}  // namespace

std::optional<double> Figure::Finish(double average) const {
  switch (averaging) {
    case Averaging::kPlain:
      break;
    case Averaging::kRootMeanSquare:
      return std::sqrt(average);
    case Averaging::kDecibelOfMeanSquare:
      return PsnrDb(average);
    case Averaging::kReciprocal:
      return Reciprocal(average);
  }
  return average;
}

std::optional<double> Figure::Unfinish(double figure) const {
  switch (averaging) {
    case Averaging::kPlain:
      break;
    case Averaging::kRootMeanSquare:
      return figure * figure;
    case Averaging::kDecibelOfMeanSquare:
      return PowerFromDb(-figure);
    case Averaging::kReciprocal:
      return Reciprocal(figure);
  }
  return figure;
}

std::optional<double> Figure::Of(const ViewMetrics& view) const {
  const std::optional<double> average = averaged(view);
  return average ? Finish(*average) : std::nullopt;
}

std::optional<double> Figure::Badness(double figure) const {
  switch (better) {
    case Better::kLower:
      return figure;
    case Better::kHigher:
      return -figure;
    case Better::kNearOne:
      return std::abs(figure - 1.0);
    case Better::kNearZero:
      return std::abs(figure);
    case Better::kNeither:
      break;
  }
  return std::nullopt;
}

const std::vector<Figure>& Figures() {
  static const std::vector<Figure> kFigures = MakeFigures();
  return kFigures;
}

std::size_t FigureIndex(std::string_view path) {
  const std::vector<Figure>& figures = Figures();
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.path == path; });
  SONARCAL_CHECK(found != figures.end(), "no figure is named {}", path);
  return static_cast<std::size_t>(found - figures.begin());
}

std::vector<std::string> QuotedFigures() {
  return {"distribution.echoes.emd_db",  "echoes.coverage_ratio",   "echoes.matched_real",
          "echoes.matched_simulated",    "intensity.whole.psnr_db", "intensity.whole.ssim",
          "texture.whole.lbp_divergence"};
}

std::string IntensityErrorPath(IntensityDomain domain) {
  return fmt::format("intensity.{}.mean_absolute", ToString(domain));
}

}  // namespace sonarcal::metrics
