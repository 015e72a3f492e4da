#include "calib/noise/noise_form.h"

#include <algorithm>
#include <cmath>

#include "calib/noise/noise_solver.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/display.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

constexpr double kUnknownSpanDb = 60.0;

double MeanRangeM(const NoiseCells& cells) {
  return 0.5 * (cells.RangeM(0) + cells.RangeM(cells.bands() - 1));
}

// Returns the lowest level above 0 that occurs; 0 if there is none.
int LeastLevelShown(const NoiseCounts& counts) {
  int least = 0;
  for (const auto& cell : counts) {
    for (const auto& [level, count] : cell) {
      if (level > 0 && (least == 0 || level < least)) least = level;
    }
  }
  return least;
}

// Mean power that explains a high quantile of the grey values, which clipped zeros do not affect.
double RoughNoisePower(const NoiseCounts& counts, const NoiseCells& cells,
                       const DisplayParameters<double>& display) {
  std::vector<double> histogram(cells.full_scale + 1);
  double all = 0.0;
  for (const auto& cell : counts) {
    for (const auto& [level, count] : cell) {
      histogram[level] += count;
      all += count;
    }
  }
  double below = 0.0;
  for (int level = 0; level < cells.full_scale; ++level) {
    below += histogram[level];
    if (below >= 0.8 * all && below < all) {
      const double power = sim::PowerFromDisplay(display, (level + 0.5) / cells.full_scale);
      return std::max(power, UnshownPower(display)) / -std::log1p(-below / all);
    }
  }
  return sim::PowerFromDisplay(display, 0.5);
}

}  // namespace

double UnshownPower(const DisplayParameters<double>& display) {
  return PowerFromDb(display.db_min - 40.0);
}

int Richness(const NoiseForm& form) {
  return (form.display.law == DisplayLaw::kSoftLog) + (form.speckle != sim::SpeckleLaw::kGamma) +
         (form.speckle == sim::SpeckleLaw::kKDiffuse) + (form.time_varied_gain != TimeVariedGain::kNone) +
         form.floor_after_gain;
}

NoiseLaw StartOf(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells, double net_db,
                 double absorption_db_per_m) {
  NoiseLaw law{.display = form.display, .receiver = {}, .speckle = form.speckle};
  const double span_db = form.display.db_max - form.display.db_min;
  // Below all recorded values, because nothing below the soft floor is ever shown.
  const double max_soft_db =
      form.display.db_min + (LeastLevelShown(counts) - 0.5) / cells.full_scale * span_db - 1.0;
  if (form.fit_soft_db) law.display.soft_db = std::min(form.display.db_min - 1.5, max_soft_db);
  const double level_db = DbFromPower(RoughNoisePower(counts, cells, law.display));
  if (form.fit_soft_db)
    law.display.soft_db = std::min(std::max(form.display.db_min - 1.5, level_db - 12.0), max_soft_db);
  ReceiverParameters& receiver = law.receiver;
  const double free_looks = MinNoiseLooks(form.speckle) < 1.0 ? 0.8 : 1.3;
  receiver.looks = form.fit_span ? 1.0 : free_looks;
  if (form.speckle == sim::SpeckleLaw::kKDiffuse) receiver.diffuse_share = 0.3;
  receiver.time_varied_gain = form.time_varied_gain;
  const double near_m = cells.RangeM(0);
  const double far_m = cells.RangeM(cells.bands() - 1);
  const auto gain_db = [&](double range_m) {
    return sim::TimeVariedGainDb(form.time_varied_gain, range_m, absorption_db_per_m);
  };
  receiver.noise_slope_db_per_m =
      (net_db - (gain_db(far_m) - gain_db(near_m))) / std::max(1e-3, far_m - near_m);
  const double middle_m = MeanRangeM(cells);
  const double shared_db = form.floor_after_gain ? 3.0 : 0.0;
  receiver.noise_db = level_db - shared_db - gain_db(middle_m) - receiver.noise_slope_db_per_m * middle_m;
  if (form.floor_after_gain) receiver.noise_after_gain_db = level_db - shared_db;
  return law;
}

std::vector<NoiseLaw> StartsOf(const NoiseForm& form, const NoiseCounts& counts, const NoiseCells& cells,
                               double absorption_db_per_m) {
  std::vector<NoiseLaw> starts;
  for (const double net_db :
       form.floor_after_gain ? std::vector<double>{-8.0, 8.0} : std::vector<double>{0.0}) {
    starts.push_back(StartOf(form, counts, cells, net_db, absorption_db_per_m));
    if (form.speckle != sim::SpeckleLaw::kKDiffuse) continue;
    NoiseLaw rare = starts.back();
    rare.receiver.looks = 0.5;
    rare.receiver.diffuse_share = 0.8;
    starts.push_back(rare);
  }
  return starts;
}

std::vector<NoiseForm> DisplayForms(const RecordingInfo& info, const NoiseFitOptions& options) {
  if (options.display) {
    std::vector<NoiseForm> forms = {{.display = *options.display}};
    forms.push_back({.display = *options.display, .speckle = sim::SpeckleLaw::kWeighted});
    return forms;
  }
  if (info.display_gamma) {
    const DisplayParameters<double> power{
        .db_min = -100.0, .db_max = 0.0, .law = DisplayLaw::kPower, .exponent = *info.display_gamma};
    return {{.display = power}, {.display = power, .speckle = sim::SpeckleLaw::kWeighted}};
  }
  DisplayParameters<double> display{.db_min = 0.0, .db_max = kUnknownSpanDb};
  std::optional<double> span = info.scale.db_span;
  if (info.scale.db_min && info.scale.db_max) {
    display.db_min = *info.scale.db_min;
    span = *info.scale.db_max - *info.scale.db_min;
  }
  if (span) display.db_max = display.db_min + *span;
  std::vector<NoiseForm> forms;
  for (const DisplayLaw law : {DisplayLaw::kLog, DisplayLaw::kSoftLog}) {
    display.law = law;
    NoiseForm form{.display = display, .fit_span = !span, .fit_soft_db = FitsSoftDb(display, options)};
    forms.push_back(form);
    form.speckle = sim::SpeckleLaw::kWeighted;
    if (span) forms.push_back(form);
  }
  return forms;
}

}  // namespace sonarcal::calib
