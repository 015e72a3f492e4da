// How well each method of segmentation finds what people outlined, as Markdown: docs/segmentation.md shows
// what it printed.
//
//   segmentation_study FOLDER [candidates=200] [methods=a,b] [chosen]
//
// FOLDER: aris3000_watertank of the recordings. The pictures are split in two halves, every second one by
// number. The parameters of a method are those with the highest mean IoU on one half, among `candidates`
// drawn at random (the same at every run); what is printed is how they do on the other half, both ways
// together: no picture is judged by parameters that saw it. In the box: the method looks, and is judged,
// within the boxes that people drew, wider by 10 pixels; whole: everywhere in the fan. `chosen` prints the
// parameters too.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "metrics/segmentation.h"
#include "metrics/segmentation_json.h"
#include "tests/metrics/human_masks.h"

namespace sonarcal::testing {
namespace {

template <typename T>
T OneOf(std::mt19937_64& random, std::initializer_list<T> values) {
  return values.begin()[random() % values.size()];
}

// Sizes are in bins and beams of pictures brought to polar as fine as they are: about a pixel each.
SegmentationOptions Candidate(SegmentationMethod method, std::mt19937_64& random) {
  SegmentationOptions options;
  options.method = method;
  options.blur_rows = options.blur_cols = OneOf(random, {0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0});
  options.open_rows = options.open_cols = OneOf(random, {0, 3, 5});
  options.close_rows = options.close_cols = OneOf(random, {0, 5, 9, 15, 21, 29});
  options.min_area_px = OneOf(random, {0, 50, 100, 200, 400});
  options.max_rows = options.max_cols = OneOf(random, {0, 60, 80, 100, 130});
  options.largest_component_only = OneOf(random, {false, false, true});
  options.fill = OneOf(random, {RegionFill::kNone, RegionFill::kHoles, RegionFill::kHull, RegionFill::kHull});

  options.sigma_count = OneOf(random, {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0});
  options.threshold_fraction = OneOf(random, {0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7});
  options.contrast = OneOf(random, {0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1, 0.12, 0.15, 0.2});
  options.guard_rows = options.guard_cols = OneOf(random, {8, 14, 20, 28, 36, 46});
  options.training_rows = options.training_cols = OneOf(random, {8, 16, 28, 40, 60, 80});
  options.false_alarm_rate = OneOf(random, {0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 3e-3, 1e-3, 1e-4, 1e-5, 1e-7});
  options.cell_rows = options.cell_cols = OneOf(random, {1, 3, 5, 7, 9});
  options.looks = OneOf(random, {0.5, 0.7, 1.0});
  options.os_quantile = OneOf(random, {0.5, 0.6, 0.75, 0.85});
  return options;
}

struct Score {
  SegmentationOptions options;
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
  double best_known_afterwards = 0.0;
  std::array<SegmentationOptions, 2> chosen;  // judged on half 0, on half 1
};

Result Study(const std::vector<HumanMask>& pictures, SegmentationMethod method, int candidates, bool in_box) {
  std::mt19937_64 random(20240601);
  std::vector<Score> scores;
  for (int i = 0; i < candidates; ++i) {
    Score score{Candidate(method, random), {}};
    for (const HumanMask& picture : pictures) {
      const Mask found = Segment(picture.image, score.options, in_box ? &picture.box : nullptr).object;
      score.by_picture.push_back(Agree(picture, found, in_box));
    }
    scores.push_back(std::move(score));
  }
  Result result;
  Score judged;
  judged.by_picture.resize(pictures.size());
  for (int half = 0; half < 2; ++half) {
    const Score* best = &scores.front();
    for (const Score& score : scores) {
      if (score.Mean(1 - half).iou > best->Mean(1 - half).iou) best = &score;
      result.best_known_afterwards = std::max(result.best_known_afterwards, score.Mean(-1).iou);
    }
    result.chosen[half] = best->options;
    for (std::size_t i = half; i < pictures.size(); i += 2) judged.by_picture[i] = best->by_picture[i];
  }
  result.held_out = judged.Mean(-1);
  return result;
}

// Not without a law of the background, which pictures of a tank's floor do not give.
constexpr std::array kStudied = {SegmentationMethod::kFixedThreshold, SegmentationMethod::kOtsu,
                                 SegmentationMethod::kTriangle,       SegmentationMethod::kBackgroundSigma,
                                 SegmentationMethod::kLocalContrast,  SegmentationMethod::kCaCfar,
                                 SegmentationMethod::kOsCfar};

void Print(const std::vector<HumanMask>& pictures, int candidates, const std::string& methods,
           bool with_chosen) {
  fmt::print("{} pictures, {} candidates a method; mean over pictures, held out\n\n", pictures.size(),
             candidates);
  fmt::print("| method | in the box: IoU | precision | recall | whole: IoU | precision | recall |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  std::string chosen;
  for (const SegmentationMethod method : kStudied) {
    const std::string name(ToString(method));
    if (!methods.empty() && ("," + methods + ",").find("," + name + ",") == std::string::npos) continue;
    fmt::print("| {} |", name);
    for (const bool in_box : {true, false}) {
      const Result result = Study(pictures, method, candidates, in_box);
      fmt::print(" {:.3f} | {:.3f} | {:.3f} |", result.held_out.iou, result.held_out.precision,
                 result.held_out.recall);
      std::cout.flush();
      for (int half = 0; half < 2; ++half) {
        chosen += fmt::format("{} {}, for half {} (best of all afterwards {:.3f}): {}\n", name,
                              in_box ? "in the box" : "whole", half, result.best_known_afterwards,
                              SegmentationJson(result.chosen[half])["parameters"].dump());
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
  int candidates = 200;
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
    std::cerr << "usage: segmentation_study FOLDER [candidates=200] [methods=a,b] [chosen]\n";
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
