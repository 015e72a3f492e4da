#include "calib/selection/model_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "calib/fit_starts.h"
#include "calib/mirror_start.h"
#include "calib/noise/background_display.h"
#include "calib/problem_builder.h"
#include "calib/selection/model_variants.h"
#include "core/types/error.h"
#include "core/types/mask.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

constexpr const char* kTrendName = "receiver.noise_slope_db_per_m";

// Start values and free parameters of a model, and the result of its fit.
struct Candidate {
  ParameterSet initial;
  FitConfig config;
  ParameterSet fitted;
  std::vector<std::vector<double>> mean_used;  // per frame and pixel
  BlockedLikelihood likelihood;                // on the held-out frames
};

class Chooser {
 public:
  Chooser(const sim::Simulator& simulator, const std::vector<GreyFrame>& used,
          const std::vector<GreyFrame>& held_out, const ModelChoiceOptions& options)
      : simulator_(simulator), used_(used), held_out_(held_out), options_(options) {}

  ModelChoice Run(const ParameterSet& initial, const FitConfig& config) {
    mirrors_ = sim::ReflectingMaterials(simulator_.caster().material_names(), initial);
    const FitOptions few = Few(options_.first_iterations, options_.fit.starts, true);
    const std::vector<CatalogEntry> catalog = Catalog(config);
    Say("selection of the model: fitting the given one");
    std::optional<Candidate> first = FitAndJudge(initial, initial, config, few);
    if (!first) throw DataError("the given model could not be fitted to the frames used");
    best_ = std::move(*first);
    // All other fits start at its values.
    std::erase_if(best_.config.start, [&](const auto& start) {
      const int entry = FindEntry(catalog, start.first);
      return entry >= 0 && !IsPlacement(catalog[static_cast<std::size_t>(entry)]);
    });
    ModelChoice choice;
    for (const ChoiceAxis axis : options_.axes) choice.axes.push_back(Decide(axis));
    choice.parameters = best_.initial;
    choice.config = best_.config;
    choice.config.start = config.start;
    choice.tie_sigmas = options_.tie_sigmas;
    for (const GreyFrame& frame : held_out_) choice.frames_chosen_on.push_back(frame.index);
    choice.pixels = pixels_;
    choice.blocks = blocks_;
    return choice;
  }

 private:
  void Say(const std::string& line) const {
    if (options_.fit.progress) options_.fit.progress(line);
  }

  FitOptions Few(int iterations, int starts, bool search_level) const {
    FitOptions few = options_.fit;
    few.max_iterations = std::min(few.max_iterations, iterations);
    few.starts = starts;
    few.search_level = search_level;
    few.down_weight = false;  // the evaluation uses all pixels, so the fit does too
    few.standard_errors = false;
    few.progress = {};
    return few;
  }

  std::vector<CatalogEntry> Catalog(const FitConfig& config) const {
    std::vector<int> indices;
    for (const GreyFrame& frame : used_) indices.push_back(frame.index);
    return BuildAcousticCatalog(
        simulator_.caster().material_names(), simulator_.sonar(), indices, mirrors_, ObjectsNamed(config),
        OutlineForms(simulator_.caster().scene(), simulator_.sonar().axes, OutlinesNamed(config)));
  }

  bool IsFree(const FitConfig& config, const std::string& name) const {
    std::vector<CatalogEntry> catalog = Catalog(config);
    const std::vector<bool> free = ApplyFitConfig(config, catalog);
    return free.at(static_cast<std::size_t>(FindEntry(catalog, name)));
  }

  // Configuration with the same priors for any start. Placements have priors about their declared values
  // only.
  FitConfig WithPriorsAbout(const ParameterSet& initial, const FitConfig& config) const {
    const std::vector<std::string>& materials = simulator_.caster().material_names();
    ParameterSet complete = sim::WithResponse(simulator_.sonar(), initial);
    for (const std::string& name : materials) complete.materials[name] = initial.Material(name);
    std::vector<CatalogEntry> catalog = Catalog(config);
    std::vector<bool> free = ApplyFitConfig(config, catalog);
    ParameterValues values(catalog.size());
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      const bool placement = IsPlacement(catalog[i]);
      if (placement) free[i] = false;
      if (!placement) values[i] = AcousticSlot(complete, materials, catalog[i]);
    }
    FitConfig result = config;
    GivePriors(values, free, catalog, result);
    return result;
  }

  // Fits from `start`, with priors about `initial`. Nullopt if there is no usable solution.
  std::optional<Candidate> FitAndJudge(const ParameterSet& initial, const ParameterSet& start,
                                       const FitConfig& config, const FitOptions& fit_options) {
    Candidate candidate{
        .initial = initial, .config = config, .fitted = {}, .mean_used = {}, .likelihood = {}};
    std::vector<AcousticFrame> frames = FramesFor(used_, start.display);
    AcousticFit fit =
        FitAcousticModel(simulator_, frames, start, WithPriorsAbout(initial, config), fit_options);
    if (!fit.usable) return std::nullopt;
    for (std::size_t f = 0; f < frames.size(); ++f) frames[f].world_from_sonar = fit.world_from_sonar[f];
    candidate.fitted = std::move(fit.parameters);
    const AcousticFrameModel seen(*fit.simulator, frames, candidate.fitted);
    candidate.mean_used = MeanPowers(seen);
    if (held_out_.empty()) return candidate;
    std::vector<AcousticFrame> judged = FramesFor(held_out_, start.display);
    for (AcousticFrame& frame : judged) frame.world_from_sonar = frame.world_from_sonar * fit.mount;
    const AcousticFrameModel model(*fit.simulator, judged, candidate.fitted);
    // Uses the same blocks for all candidates, whatever beam they have.
    if (!block_) block_ = BlockSize(model, options_.fit);
    candidate.likelihood =
        GreyLikelihood(held_out_, MeanPowers(model), candidate.fitted, block_->bins, block_->beams);
    candidate.likelihood.variance_factor = block_->variance_factor;
    return candidate;
  }

  std::vector<ModelVariant> LooksVariants(JudgedAxis& axis) const {
    constexpr double kAlike = 0.01;
    const double given = best_.initial.receiver.looks;
    const double best = BestLooks(used_, best_.mean_used, best_.fitted);
    const auto with = [](const std::string& name, double looks, int values) {
      return ModelVariant{.name = name, .fitted_values = values, .apply = [looks](ParameterSet& p) {
                            p.receiver.looks = looks;
                          }};
    };
    std::vector<ModelVariant> variants = {{.name = fmt::format("{:g}", given), .given = true}};
    if (given != 1.0) variants.push_back(with("1", 1.0, 0));
    if (std::abs(best - given) < kAlike * given || std::abs(best - 1.0) < kAlike) {
      axis.notes.push_back(fmt::format("Number of looks that fits the frames used best: {:.2f}.", best));
    } else {
      variants.push_back(with(fmt::format("{:.3g}, fitted to the frames used", best), best, 1));
    }
    return variants;
  }

  std::vector<ModelVariant> TrendVariants() const {
    const double given = best_.initial.receiver.noise_slope_db_per_m;
    FitConfig free = best_.config;
    std::erase(free.fixed, kTrendName);
    free.free->emplace_back(kTrendName);
    FitConfig held = best_.config;
    held.fixed.emplace_back(kTrendName);
    const bool free_now = IsFree(best_.config, kTrendName);
    if (!free_now && !IsFree(free, kTrendName))
      throw DataError("--choose trend: the configuration fixes {}", kTrendName);
    return {{.name = given == 0.0 ? "none" : fmt::format("{:g} dB/m, as given", given),
             .given = !free_now,
             .apply = [given](ParameterSet& p) { p.receiver.noise_slope_db_per_m = given; },
             .configure = [held](FitConfig& config) { config = held; }},
            {.name = "free", .fitted_values = 1, .given = free_now, .configure = [free](FitConfig& config) {
               config = free;
             }}};
  }

  // Pixels in which the expected echoes are far below the noise.
  Mask BackgroundOfFirst() const {
    constexpr double kEchoOverNoise = 0.05;
    const GreyFrame& frame = used_.front();
    const PolarAxes& axes = frame.image.axes;
    const sim::ReceiverNoise noise(best_.fitted.receiver, axes, simulator_.absorption_db_per_m());
    Mask background(axes.range_bins, axes.beam_count());
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      for (int beam = 0; beam < axes.beam_count(); ++beam) {
        const std::size_t pixel = static_cast<std::size_t>(bin) * axes.beam_count() + beam;
        if (!frame.use.empty() && frame.use[pixel] == 0) continue;
        const double floor = noise.Power(bin, beam);
        background(bin, beam) = best_.mean_used.front()[pixel] < (1.0 + kEchoOverNoise) * floor ? 1 : 0;
      }
    }
    return background;
  }

  // Display laws softened as the background shows, on the levels of the given law. The slope stays, and the
  // noise moves to its level in the new law.
  std::vector<ModelVariant> DisplayVariants(JudgedAxis& axis) const {
    constexpr std::ptrdiff_t kMinPixels = 1000;
    const DisplayParameters<double>& given = best_.initial.display;
    if (given.law == DisplayLaw::kPower) {
      throw DataError("--choose display: the display is a power law, which has no variants");
    }
    std::vector<ModelVariant> variants = {{.name = DisplayName(given.law),
                                           .fitted_values = given.law == DisplayLaw::kLog ? 0 : 1,
                                           .given = true}};
    if (given.law != DisplayLaw::kLog) {
      variants.push_back({.name = DisplayName(DisplayLaw::kLog),
                          .apply = [](ParameterSet& p) { p.display.law = DisplayLaw::kLog; }});
    }
    const Mask background = BackgroundOfFirst();
    const auto pixels = std::count(background.values().begin(), background.values().end(), 1);
    if (pixels < kMinPixels) {
      axis.notes.push_back(fmt::format(
          "No softened law was tried: frame {} has {} pixels of background, at least {} are needed.",
          used_.front().index, pixels, kMinPixels));
      return variants;
    }
    PolarImage image = used_.front().image;
    image.scale.db_span = given.db_max - given.db_min;
    for (const DisplayLaw law : {DisplayLaw::kSoftLog, DisplayLaw::kSoftAmplitude}) {
      if (law == given.law) continue;
      const BackgroundDisplay read =
          FitBackgroundDisplay(image, background, law, best_.initial.receiver.looks);
      // The noise is 0 dB in `read`. Shifts the levels so that the display begins at the given db_min.
      const double noise_db = given.db_min - read.display.db_min;
      const double soft_db = read.display.soft_db + noise_db;
      variants.push_back(
          {.name = fmt::format("{}, at {:.1f} dB over the noise", DisplayName(law), read.display.soft_db),
           .fitted_values = 1,
           .apply = [law, soft_db, noise_db](ParameterSet& p) {
             p.display.law = law;
             p.display.soft_db = soft_db;
             p.receiver.noise_db = noise_db;
           }});
    }
    return variants;
  }

  std::vector<ModelVariant> VariantsOf(ChoiceAxis kind, JudgedAxis& axis) const {
    switch (kind) {
      case ChoiceAxis::kPattern:
        return AzimuthVariants(best_.initial.beam);
      case ChoiceAxis::kElevation:
        return ElevationVariants(best_.initial.beam);
      case ChoiceAxis::kMirrors:
        if (best_.initial.mirrors.empty())
          throw DataError("the axis 'mirrors' has nothing to choose: the parameters have no mirror");
        return MirrorLobeVariants(best_.initial.beam);
      case ChoiceAxis::kLooks:
        return LooksVariants(axis);
      case ChoiceAxis::kTrend:
        return TrendVariants();
      case ChoiceAxis::kDisplay:
        break;
    }
    return DisplayVariants(axis);
  }

  // The display law that the background of the first frame used shows, by itself.
  JudgedAxis DecideDisplayByBackground() {
    constexpr int kBandBins = 8;
    constexpr int kBlockBeams = 8;
    constexpr std::ptrdiff_t kMinPixels = 1000;
    JudgedAxis axis{.axis = ChoiceAxis::kDisplay, .variants = {}, .notes = {}};
    const DisplayParameters<double> given = best_.initial.display;
    const Mask background = BackgroundOfFirst();
    const auto pixels = std::count(background.values().begin(), background.values().end(), 1);
    if (pixels < kMinPixels) {
      throw DataError(
          "the display cannot be chosen: frame {} has {} pixels of background, expected {} or more",
          used_.front().index, pixels, kMinPixels);
    }
    GreyFrame judged = used_.front();
    PolarImage& image = judged.image;
    if (!image.scale.db_span && image.scale.db_min && image.scale.db_max)
      image.scale.db_span = *image.scale.db_max - *image.scale.db_min;
    axis.notes.push_back(
        fmt::format("No other frame judges the display: each law was fitted to every second band of {} range "
                    "bins of the background of frame {} ({} pixels), and evaluated on the others. Echoes "
                    "brighter than the background do not test it.",
                    kBandBins, judged.index, pixels));
    axis.notes.push_back(
        image.scale.db_span
            ? fmt::format("The recording states a span of {:g} dB, which is kept.", *image.scale.db_span)
            : fmt::format("The recording states no dB scale: span or exponent are fitted with {:g} looks, "
                          "because background alone determines only one number for the two.",
                          best_.initial.receiver.looks));
    const double looks = best_.initial.receiver.looks;
    Mask fitted = background;
    judged.use.assign(background.values().begin(), background.values().end());
    for (std::size_t i = 0; i < judged.use.size(); ++i) {
      const bool odd = i / static_cast<std::size_t>(image.axes.beam_count()) / kBandBins % 2 != 0;
      (odd ? fitted.values()[i] : judged.use[i]) = 0;
    }
    const std::vector<std::vector<double>> noise = {std::vector<double>(judged.use.size(), 1.0)};
    std::vector<DisplayLaw> laws;
    std::vector<BlockedLikelihood> likelihoods;
    for (const auto& [word, law] : WordsOf(std::type_identity<DisplayLaw>{})) {
      Say(fmt::format("choice of display: {}", word));
      ParameterSet of = best_.initial;
      of.display = FitBackgroundDisplay(image, fitted, law, looks).display;
      likelihoods.push_back(GreyLikelihood({judged}, noise, of, kBandBins, kBlockBeams));
      laws.push_back(law);
      // Beyond the level and, where it is not stated, the span or the exponent.
      const bool plain = law == DisplayLaw::kLog || (law == DisplayLaw::kPower && !image.scale.db_span);
      const int own = plain ? 0 : 1;
      axis.variants.push_back({.name = DisplayName(law),
                               .fitted_values = own,
                               .given = law == given.law,
                               .usable = true,
                               .behind = {}});
    }
    std::vector<const BlockedLikelihood*> judged_by;
    for (const BlockedLikelihood& likelihood : likelihoods) judged_by.push_back(&likelihood);
    const std::size_t chosen = Compare(judged_by, axis.variants);
    const BackgroundDisplay read = FitBackgroundDisplay(image, background, laws[chosen], looks);
    // The noise is 0 dB in `read`. Shifts the levels so that the display keeps the given level of its gauge.
    const double noise_db = laws[chosen] == DisplayLaw::kPower ? given.db_max - read.display.db_max
                                                               : given.db_min - read.display.db_min;
    for (ParameterSet* p : {&best_.initial, &best_.fitted}) {
      p->display = read.display;
      p->display.db_min += noise_db;
      p->display.db_max += noise_db;
      p->display.soft_db += noise_db;
      p->receiver.noise_db = noise_db;
    }
    axis.notes.push_back(fmt::format(
        "Display {}: {:.4g} to {:.4g} dB, noise at {:.4g} dB{}; largest "
        "difference of the cumulative distributions of the background {:.4f}.",
        ToString(laws[chosen]), best_.initial.display.db_min, best_.initial.display.db_max, noise_db,
        laws[chosen] == DisplayLaw::kPower ? fmt::format(", exponent {:.3g}", read.display.exponent)
        : laws[chosen] != DisplayLaw::kLog
            ? fmt::format(", softened at {:.4g} dB", best_.initial.display.soft_db)
            : std::string(),
        read.ks));
    pixels_ = likelihoods[chosen].Pixels();
    blocks_ =
        static_cast<int>(std::ranges::count_if(likelihoods[chosen].pixels, [](double n) { return n > 0.0; }));
    return axis;
  }

  JudgedAxis Decide(ChoiceAxis kind) {
    if (held_out_.empty()) return DecideDisplayByBackground();
    JudgedAxis axis{.axis = kind, .variants = {}, .notes = {}};
    const std::vector<ModelVariant> variants = VariantsOf(kind, axis);
    std::vector<std::optional<Candidate>> candidates;
    for (std::size_t i = 0; i < variants.size(); ++i) {
      const ModelVariant& variant = variants[i];
      if (variant.given) {
        candidates.emplace_back(best_);
      } else {
        Say(fmt::format("choice of {}, {} of {}: {}", ToString(kind), i + 1, variants.size(), variant.name));
        ParameterSet initial = best_.initial;
        ParameterSet start = best_.fitted;
        FitConfig config = best_.config;
        variant.apply(initial);
        variant.apply(start);
        variant.configure(config);
        candidates.push_back(FitAndJudge(initial, start, config, Few(options_.iterations, 1, false)));
      }
      axis.variants.push_back({.name = variant.name,
                               .fitted_values = variant.fitted_values,
                               .given = variant.given,
                               .usable = candidates.back().has_value(),
                               .behind = {}});
    }
    std::vector<const BlockedLikelihood*> judged;
    for (const std::optional<Candidate>& candidate : candidates)
      judged.push_back(candidate ? &candidate->likelihood : nullptr);
    best_ = *candidates[Compare(judged, axis.variants)];
    pixels_ = best_.likelihood.Pixels();
    blocks_ = static_cast<int>(
        std::ranges::count_if(best_.likelihood.pixels, [](double pixels) { return pixels > 0.0; }));
    return axis;
  }

  // Fills in the figures. Returns the index of the selected variant. Null: no usable fit.
  std::size_t Compare(const std::vector<const BlockedLikelihood*>& candidates,
                      std::vector<JudgedVariant>& judged) const {
    std::size_t best = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!candidates[i]) continue;
      judged[i].nats_per_pixel = candidates[i]->PerPixel();
      if (judged[i].nats_per_pixel > most) std::tie(best, most) = std::pair(i, judged[i].nats_per_pixel);
    }
    std::size_t chosen = best;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!candidates[i]) continue;
      judged[i].behind = Difference(*candidates[best], *candidates[i]);
      judged[i].tied = judged[i].behind.mean <= options_.tie_sigmas * judged[i].behind.sigma;
      if (!judged[i].tied) continue;
      const auto rank = [&](std::size_t k) { return std::pair(judged[k].fitted_values, !judged[k].given); };
      if (rank(i) < rank(chosen)) chosen = i;
    }
    judged[chosen].chosen = true;
    return chosen;
  }

  const sim::Simulator& simulator_;
  const std::vector<GreyFrame>& used_;
  const std::vector<GreyFrame>& held_out_;
  const ModelChoiceOptions& options_;
  Candidate best_;
  std::vector<char> mirrors_;  // materials that reflect, 1 or 0
  std::optional<BlockPixels> block_;
  double pixels_ = 0.0;  // of the last axis
  int blocks_ = 0;
};

}  // namespace

ModelChoice ChooseModel(const sim::Simulator& simulator, const std::vector<GreyFrame>& used,
                        const std::vector<GreyFrame>& held_out, const ParameterSet& initial,
                        const FitConfig& config, const ModelChoiceOptions& options) {
  if (used.empty()) throw DataError("fit: no frames");
  if (held_out.empty()) {
    for (const ChoiceAxis axis : options.axes) {
      if (axis == ChoiceAxis::kDisplay) continue;
      throw DataError(
          "--choose {} needs held-out frames, but no frame is held out; expected another frame, or display "
          "alone, which the background of one frame determines",
          ToString(axis));
    }
  }
  ParameterSet complete = WithNoiseStart(initial, FramesFor(used, initial.display));
  const std::vector<std::string>& materials = simulator.caster().material_names();
  FitConfig of = config;
  if (!of.free) of.free = AcousticFreeByDefault(initial, materials);
  complete = WithMirrorStart(complete, of, materials, simulator.sonar());
  return Chooser(simulator, used, held_out, options).Run(complete, of);
}

}  // namespace sonarcal::calib
