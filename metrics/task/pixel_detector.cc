#include "metrics/task/pixel_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>

#include "core/math/local_sums.h"
#include "core/math/statistics.h"
#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

constexpr std::size_t kSamples = 400;  // of each class and frame
constexpr int kTrees = 30;
constexpr int kDepth = 10;
constexpr int kMinSamples = 10;
constexpr std::uint64_t kSeed = 20240107;

// Box mean and standard deviation around each pixel.
struct Surroundings {
  Grid<double> mean;
  Grid<double> spread;
};

Surroundings SurroundingsOf(const Grid<double>& share, int size) {
  Grid<double> square = share;
  for (double& value : square.values()) value *= value;
  Surroundings around{BoxMean(share, size, size), BoxMean(square, size, size)};
  for (std::size_t i = 0; i < share.size(); ++i) {
    const double mean = around.mean.values()[i];
    around.spread.values()[i] = std::sqrt(std::max(0.0, around.spread.values()[i] - mean * mean));
  }
  return around;
}

// Draws pixels whose label is `label`.
std::vector<std::size_t> Draw(const Mask& object, int label, std::mt19937_64& random) {
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if ((object.values()[i] != 0) == (label != 0)) pixels.push_back(i);
  }
  const std::size_t count = std::min(kSamples, pixels.size());
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(pixels[i], pixels[i + random() % (pixels.size() - i)]);
  }
  pixels.resize(count);
  return pixels;
}

}  // namespace

struct PixelDetector::Forest {
  cv::Ptr<cv::ml::RTrees> trees = cv::ml::RTrees::create();
};

Grid<float> PixelFeatures(const Grid<float>& value, double full_scale) {
  SONARCAL_CHECK(value.size() > 0 && full_scale > 0.0, "features of {} pixels, full scale {}", value.size(),
                 full_scale);
  const double median = Median(std::vector<float>(value.values().begin(), value.values().end())) / full_scale;
  Grid<double> share(value.rows(), value.cols());
  for (std::size_t i = 0; i < value.size(); ++i) share.values()[i] = value.values()[i] / full_scale - median;
  const Surroundings near = SurroundingsOf(share, 3);
  const Surroundings middle = SurroundingsOf(share, 9);
  const Surroundings far = SurroundingsOf(share, 27);
  Grid<float> features(static_cast<int>(value.size()), kPixelFeatures);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double mean_3 = near.mean.values()[i];
    const double mean_9 = middle.mean.values()[i];
    const double mean_27 = far.mean.values()[i];
    const std::array<double, kPixelFeatures> of_pixel = {
        share.values()[i],     mean_3, mean_3 - mean_9, mean_9 - mean_27, mean_27, middle.spread.values()[i],
        far.spread.values()[i]};
    for (int f = 0; f < kPixelFeatures; ++f) {
      features(static_cast<int>(i), f) = static_cast<float>(of_pixel[f]);
    }
  }
  return features;
}

PixelDetector::PixelDetector(const std::vector<const LabelledFrame*>& frames, std::string_view use)
    : forest_(std::make_unique<Forest>()) {
  std::mt19937_64 random(kSeed);
  cv::Mat1f samples(0, kPixelFeatures);
  cv::Mat1f labels(0, 1);
  std::array<std::size_t, 2> drawn = {};
  for (const LabelledFrame* frame : frames) {
    Grid<float> features = PixelFeatures(frame->value, frame->full_scale);
    for (const int label : {0, 1}) {
      for (const std::size_t pixel : Draw(frame->object, label, random)) {
        samples.push_back(cv::Mat(1, kPixelFeatures, CV_32F, &features(static_cast<int>(pixel), 0)));
        labels.push_back(static_cast<float>(label));
        ++drawn[label];
      }
    }
  }
  if (drawn[0] == 0 || drawn[1] == 0) {
    throw DataError("{} {} frames have {} object pixels and {} others, expected some of both", frames.size(),
                    use, drawn[1], drawn[0]);
  }
  // A regression forest of the labels 0 and 1: its mean is the share of objects.
  cv::ml::RTrees& trees = *forest_->trees;
  trees.setMaxDepth(kDepth);
  trees.setMinSampleCount(kMinSamples);
  trees.setTermCriteria(cv::TermCriteria(cv::TermCriteria::MAX_ITER, kTrees, 0.0));
  cv::theRNG().state = kSeed;  // of this thread; the trees draw from it
  trees.train(cv::ml::TrainData::create(samples, cv::ml::ROW_SAMPLE, labels));
}

PixelDetector::~PixelDetector() = default;
PixelDetector::PixelDetector(PixelDetector&&) noexcept = default;
PixelDetector& PixelDetector::operator=(PixelDetector&&) noexcept = default;

Grid<float> PixelDetector::Score(const LabelledFrame& frame) const {
  Grid<float> features = PixelFeatures(frame.value, frame.full_scale);
  const cv::Mat samples(features.rows(), kPixelFeatures, CV_32F, features.values().data());
  cv::Mat1f scores;
  forest_->trees->predict(samples, scores);
  Grid<float> score(frame.value.rows(), frame.value.cols());
  std::ranges::copy(scores, score.values().begin());
  return score;
}

}  // namespace sonarcal::metrics
