// How well each method of segmentation finds what people outlined, as Markdown: docs/studies/segmentation.md
// shows what it printed.
//
//   segmentation_study FOLDER [candidates=120] [methods=a,b] [chosen]
//
// FOLDER: aris3000_watertank of the recordings. The pictures are split in two halves, every second one by
// number. The parameters of a method are chosen by mean IoU on one half: the best of `candidates` drawn at
// random (the same at every run), then one knob after the other at its best. What is printed is how they do
// on the other half, both ways together: no picture is judged by parameters that saw it. In the box: the
// method looks, and is judged, within the boxes that people drew, wider by 10 pixels; whole: everywhere in
// the fan. `chosen` prints the parameters too.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "metrics/json/segmentation_json.h"
#include "metrics/segmentation/segmentation.h"
#include "tests/metrics/human_masks.h"

namespace sonarcal::testing {
namespace {

// What may be chosen: a list of values, in order, and what one of them sets. Sizes are in range bins; a beam
// is about as wide as a bin where most objects lie, so that one knob sets both. Few knobs: half of the
// pictures choose, and many would be fitted to those alone.
struct Knob {
  std::vector<double> values;
  void (*set)(metrics::SegmentationOptions& options, double value);
};

std::vector<Knob> KnobsOf(metrics::SegmentationMethod method) {
  using Options = metrics::SegmentationOptions;
  std::vector<Knob> knobs = {
      {{0, 2, 3}, [](Options& o, double v) { o.open_rows = o.open_cols = static_cast<int>(v); }},
      {{0, 3, 5, 7, 9, 11, 15},
       [](Options& o, double v) { o.close_rows = o.close_cols = static_cast<int>(v); }},
      {{0, 20, 40, 60, 90}, [](Options& o, double v) { o.min_area_px = static_cast<int>(v); }},
      {{30, 40, 50, 65, 0}, [](Options& o, double v) { o.max_rows = o.max_cols = static_cast<int>(v); }},
      {{0, 1}, [](Options& o, double v) { o.largest_component_only = v != 0.0; }},
      {{0, 1}, [](Options& o, double v) {
         o.fill = v == 0.0 ? metrics::RegionFill::kNone : metrics::RegionFill::kHull;
       }}};
  const auto add = [&](std::vector<double> values, void (*set)(Options&, double)) {
    knobs.push_back({std::move(values), set});
  };
  if (metrics::StatesFalseAlarmRate(method)) {
    add({0.3, 0.5, 0.8, 1.2, 1.6, 2, 2.5, 3, 4, 5, 7, 10, 14},
        [](Options& o, double v) { o.false_alarm_rate = std::pow(10.0, -v); });
    add({1, 3, 5, 7}, [](Options& o, double v) { o.cell_rows = o.cell_cols = static_cast<int>(v); });
  } else {
    add({0, 0.5, 1, 1.5, 2, 2.5}, [](Options& o, double v) { o.blur_rows = o.blur_cols = v; });
  }
  if (method == metrics::SegmentationMethod::kBackgroundSigma) {
    add({0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8}, [](Options& o, double v) { o.sigma_count = v; });
  }
  if (method == metrics::SegmentationMethod::kFixedThreshold) {
    add({0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7},
        [](Options& o, double v) { o.threshold_fraction = v; });
  }
  if (method == metrics::SegmentationMethod::kLocalContrast) {
    add({0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12, 0.15, 0.18, 0.21, 0.25, 0.3, 0.35},
        [](Options& o, double v) { o.contrast = v; });
  }
  if (method == metrics::SegmentationMethod::kOsCfar) {
    add({0.5, 0.65, 0.8}, [](Options& o, double v) { o.os_quantile = v; });
  }
  if (method == metrics::SegmentationMethod::kLocalContrast ||
      method == metrics::SegmentationMethod::kCaCfar || method == metrics::SegmentationMethod::kOsCfar) {
    add({1, 2, 3, 5, 7, 10, 14, 18, 24},
        [](Options& o, double v) { o.guard_rows = o.guard_cols = static_cast<int>(v); });
    add({4, 8, 14, 20, 30},
        [](Options& o, double v) { o.training_rows = o.training_cols = static_cast<int>(v); });
  }
  return knobs;
}

// The place of each knob's value in its list.
using Setting = std::vector<int>;

metrics::SegmentationOptions OptionsOf(metrics::SegmentationMethod method, const std::vector<Knob>& knobs,
                                       const Setting& at) {
  metrics::SegmentationOptions options;
  options.method = method;
  for (std::size_t k = 0; k < knobs.size(); ++k) knobs[k].set(options, knobs[k].values[at[k]]);
  return options;
}

struct Score {
  metrics::SegmentationOptions options;
  std::vector<Agreement> by_picture;

  Agreement Mean(int half) const {
    Agreement mean;
    double count = 0.0;
    for (std::size_t i = 0; i < by_picture.size(); ++i) {
      if (half >= 0 && static_cast<int>(i % 2) != half) continue;
      mean.iou += by_picture[i].iou;
      mean.precision += by_picture[i].precision;
      mean.recall += by_picture[i].recall;
      ++count;
    }
    return {mean.iou / count, mean.precision / count, mean.recall / count};
  }
};

struct Result {
  Agreement held_out;
  std::array<metrics::SegmentationOptions, 2> chosen;  // judged on half 0, on half 1
  std::array<double, 2> where_chosen{};                // mean IoU on the other half
};

// Tries settings of one method, each once.
class Search {
 public:
  Search(const std::vector<HumanMask>& pictures, metrics::SegmentationMethod method, bool in_box)
      : pictures_(pictures), method_(method), in_box_(in_box), knobs_(KnobsOf(method)) {}

  const Score& At(const Setting& setting) {
    const auto known = scores_.find(setting);
    if (known != scores_.end()) return known->second;
    Score score{OptionsOf(method_, knobs_, setting), {}};
    for (const HumanMask& picture : pictures_) {
      const Mask found =
          metrics::Segment(picture.image, score.options, in_box_ ? &picture.box : nullptr).object;
      score.by_picture.push_back(Agree(picture, found, in_box_));
    }
    return scores_.emplace(setting, std::move(score)).first->second;
  }

  // The best of `candidates` random settings on a half; then from each of the kStarts best of them the best
  // value of one knob after the other, until none is better; and of where these end the best.
  const Score& Best(int half, int candidates) {
    constexpr std::size_t kStarts = 6;
    std::mt19937_64 random(20240601);
    std::vector<Setting> starts;
    for (int i = 0; i < candidates; ++i) {
      Setting setting;
      for (const Knob& knob : knobs_) setting.push_back(static_cast<int>(random() % knob.values.size()));
      starts.push_back(setting);
      At(setting);
    }
    const auto is_better = [&](const Setting& a, const Setting& b) {
      return At(a).Mean(half).iou > At(b).Mean(half).iou;
    };
    std::stable_sort(starts.begin(), starts.end(), is_better);
    starts.resize(std::min(kStarts, starts.size()));
    for (Setting& start : starts) start = Climb(start, is_better);
    return At(*std::min_element(starts.begin(), starts.end(), is_better));
  }

 private:
  template <typename IsBetter>
  Setting Climb(Setting best, IsBetter is_better) {
    for (bool better = true; better;) {
      better = false;
      for (std::size_t k = 0; k < knobs_.size(); ++k) {
        for (int value = 0; value < static_cast<int>(knobs_[k].values.size()); ++value) {
          Setting next = best;
          next[k] = value;
          if (!is_better(next, best)) continue;
          best = next;
          better = true;
        }
      }
    }
    return best;
  }

  const std::vector<HumanMask>& pictures_;
  metrics::SegmentationMethod method_;
  bool in_box_;
  std::vector<Knob> knobs_;
  std::map<Setting, Score> scores_;
};

Result Study(const std::vector<HumanMask>& pictures, metrics::SegmentationMethod method, int candidates,
             bool in_box) {
  Search search(pictures, method, in_box);
  Result result;
  Score judged;
  judged.by_picture.resize(pictures.size());
  for (int half = 0; half < 2; ++half) {
    const Score& best = search.Best(1 - half, candidates);
    result.chosen[half] = best.options;
    result.where_chosen[half] = best.Mean(1 - half).iou;
    for (std::size_t i = half; i < pictures.size(); i += 2) judged.by_picture[i] = best.by_picture[i];
  }
  result.held_out = judged.Mean(-1);
  return result;
}

// Not without a law of the background, which pictures of a tank's floor do not give.
constexpr std::array kStudied = {
    metrics::SegmentationMethod::kFixedThreshold, metrics::SegmentationMethod::kOtsu,
    metrics::SegmentationMethod::kTriangle,       metrics::SegmentationMethod::kBackgroundSigma,
    metrics::SegmentationMethod::kLocalContrast,  metrics::SegmentationMethod::kCaCfar,
    metrics::SegmentationMethod::kOsCfar};

void Print(const std::vector<HumanMask>& pictures, int candidates, const std::string& methods,
           bool with_chosen) {
  fmt::print("{} pictures, {} random candidates a method; means over pictures, held out\n\n", pictures.size(),
             candidates);
  fmt::print("| method | in the box: IoU | precision | recall | whole: IoU | precision | recall |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  std::string chosen;
  for (const metrics::SegmentationMethod method : kStudied) {
    const std::string name(ToString(method));
    if (!methods.empty() && ("," + methods + ",").find("," + name + ",") == std::string::npos) continue;
    fmt::print("| {} |", name);
    for (const bool in_box : {true, false}) {
      const Result result = Study(pictures, method, candidates, in_box);
      fmt::print(" {:.3f} | {:.3f} | {:.3f} |", result.held_out.iou, result.held_out.precision,
                 result.held_out.recall);
      std::fflush(stdout);
      for (int half = 0; half < 2; ++half) {
        chosen += fmt::format("{} {}, judged on half {} (IoU {:.3f} where chosen): {}\n", name,
                              in_box ? "in the box" : "whole", half, result.where_chosen[half],
                              metrics::SegmentationJson(result.chosen[half])["parameters"].dump());
      }
    }
    fmt::print("\n");
  }
  if (with_chosen) fmt::print("\n{}", chosen);
}

}  // namespace
}  // namespace sonarcal::testing

int main(int argc, char** argv) {
  std::string folder, methods;
  int candidates = 120;
  bool with_chosen = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind("candidates=", 0) == 0) {
      candidates = std::atoi(argument.substr(11).c_str());
    } else if (argument.rfind("methods=", 0) == 0) {
      methods = argument.substr(8);
    } else if (argument == "chosen") {
      with_chosen = true;
    } else {
      folder = argument;
    }
  }
  if (folder.empty() || candidates < 1) {
    std::cerr << "usage: segmentation_study FOLDER [candidates=120] [methods=a,b] [chosen]\n";
    return 2;
  }
  try {
    sonarcal::testing::Print(sonarcal::testing::ReadHumanMasks(folder), candidates, methods, with_chosen);
  } catch (const std::exception& error) {
    std::cerr << "segmentation_study: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
