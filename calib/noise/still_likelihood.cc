#include "calib/noise/still_likelihood.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/types/units.h"
#include "sim/physics/display.h"
#include "sim/physics/frozen_speckle.h"

namespace sonarcal::calib {
namespace {

constexpr int kMaxClasses = 512;
constexpr int kMaxNodes = 600;
constexpr std::size_t kChunk = 2048;  // pixels; fixed, so that sums do not depend on the number of threads
constexpr double kShapeStepDb = 0.5;  // noise shapes are rounded to it
constexpr double kLeastStillChance = 1e-12;
constexpr float kNegligibleLog = -25.0F;
constexpr int kIterations = 40;

std::size_t ChunkCount(std::size_t pixels) {
  return (pixels + kChunk - 1) / kChunk;
}

// Amplitude above all that the brightest pixels may have.
double HighestNode(double brightest_db) {
  return 1.1 * AmplitudeFromDb(brightest_db) + 3.0;
}

// Spacing of the amplitude nodes, in units of the noise amplitude. Amplitudes are determined to 1 / sqrt(2 L
// frames); the nodes are closer, so that the grid does not act as noise. Where that takes more than kMaxNodes
// nodes up to kMinBrightestDb, the nodes are as close as these allow: less than 0.011 apart, which adds 2e-5
// of the noise power per look.
double Spacing(double looks, int frames) {
  return std::max(0.7 / std::sqrt(2.0 * looks * frames), HighestNode(kMinBrightestDb) / kMaxNodes);
}

}  // namespace

double BrightestUsedDb(double looks, int frames, double asked_db) {
  const double highest = (kMaxNodes * Spacing(looks, frames) - 3.0) / 1.1;
  return std::min(asked_db, std::max(kMinBrightestDb, 2.0 * DbFromPower(highest)));
}

GreyClasses::GreyClasses(const DisplayParameters<double>& display, double full_scale) {
  const int levels = static_cast<int>(full_scale) + 1;
  levels_in_class_ = (levels + kMaxClasses - 1) / kMaxClasses;
  const auto power_at = [&](double grey) { return sim::PowerFromDisplay(display, grey / full_scale); };
  const int classes = (levels + levels_in_class_ - 1) / levels_in_class_;
  for (int c = 1; c < classes; ++c) edges_.push_back(power_at(c * levels_in_class_ - 0.5));
  for (int c = 0; c < classes; ++c) {
    power_.push_back(c == 0             ? edges_.front()
                     : c == classes - 1 ? edges_.back()
                                        : power_at((c + 0.5) * levels_in_class_ - 0.5));
  }
}

int GreyClasses::Of(double grey) const {
  return std::clamp(static_cast<int>(std::lround(grey)) / levels_in_class_, 0, count() - 1);
}

StillLikelihood::StillLikelihood(const GreyClasses& classes, double looks, int frames,
                                 std::vector<std::uint16_t> classes_of,
                                 const std::vector<float>& noise_shape_db, double brightest_db)
    : classes_(classes), looks_(looks), frames_(frames), classes_of_(std::move(classes_of)) {
  std::map<long, std::uint16_t> found;
  for (const float shape_db : noise_shape_db) {
    const long step = std::lround(shape_db / kShapeStepDb);
    const auto [at, fresh] = found.try_emplace(step, static_cast<std::uint16_t>(shapes_db_.size()));
    if (fresh) shapes_db_.push_back(static_cast<double>(step) * kShapeStepDb);
    shape_index_.push_back(at->second);
  }
  const double spacing = Spacing(looks, frames);
  const int nodes = static_cast<int>(std::ceil(HighestNode(brightest_db) / spacing));
  for (int j = 0; j < nodes; ++j) amplitude_.push_back((j + 0.5) * spacing);
}

// Tables per noise shape: class x node.
std::vector<std::vector<float>> StillLikelihood::LogTables(double noise_db) const {
  const std::size_t nodes = amplitude_.size();
  const std::vector<double>& edges = classes_.edges();
  std::vector<std::vector<float>> tables(shapes_db_.size(), std::vector<float>(nodes * classes_.count()));
  tbb::parallel_for(std::size_t{0}, shapes_db_.size() * nodes, [&](std::size_t task) {
    const std::size_t shape = task / nodes;
    const std::size_t node = task % nodes;
    const double noise = PowerFromDb(noise_db + shapes_db_[shape]);
    const double echo = amplitude_[node] * amplitude_[node];
    double below = 0.0;
    for (int c = 0; c < classes_.count(); ++c) {
      const double up_to =
          c + 1 < classes_.count() ? sim::FrozenPowerCdf(looks_, echo, edges[c] / noise) : 1.0;
      tables[shape][c * nodes + node] =
          static_cast<float>(std::log(std::max(up_to - below, kLeastStillChance)));
      below = up_to;
    }
  });
  return tables;
}

std::vector<StillLikelihood::Chunk> StillLikelihood::Chunks(double noise_db) const {
  const std::vector<std::vector<float>> tables = LogTables(noise_db);
  const std::size_t nodes = amplitude_.size();
  std::vector<Chunk> chunks(ChunkCount(size()));
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t index) {
    std::vector<float> sum(nodes);
    Chunk& chunk = chunks[index];
    for (std::size_t i = index * kChunk; i < std::min(size(), (index + 1) * kChunk); ++i) {
      std::fill(sum.begin(), sum.end(), 0.0F);
      for (int k = 0; k < frames_; ++k) {
        const float* row = &tables[shape_index_[i]][classes_of_[i * frames_ + k] * nodes];
        for (std::size_t j = 0; j < nodes; ++j) sum[j] += row[j];
      }
      const float highest = *std::max_element(sum.begin(), sum.end());
      const auto counts = [&](float value) { return value > highest + kNegligibleLog; };
      const auto first = std::find_if(sum.begin(), sum.end(), counts);
      const auto last = std::find_if(sum.rbegin(), sum.rend(), counts).base();
      chunk.windows.push_back({.first_node = static_cast<std::uint32_t>(first - sum.begin()),
                               .count = static_cast<std::uint32_t>(last - first),
                               .start = chunk.values.size(),
                               .log_scale = highest});
      for (auto at = first; at != last; ++at) chunk.values.push_back(std::exp(*at - highest));
    }
  });
  return chunks;
}

std::vector<double> StillLikelihood::Profile(double noise_db, std::vector<double>& weights) const {
  const std::vector<Chunk> chunks = Chunks(noise_db);
  const std::size_t nodes = amplitude_.size();
  // Start weights of a field with uniform phase: proportional to the amplitude.
  if (weights.empty()) weights = amplitude_;
  std::vector<double> log_likelihood(size());
  std::vector<std::vector<double>> share(chunks.size());
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t index) {
      share[index].assign(nodes, 0.0);
      std::size_t i = index * kChunk;
      for (const Window& window : chunks[index].windows) {
        const float* value = &chunks[index].values[window.start];
        const double* weight = &weights[window.first_node];
        double sum = 0.0;
        for (std::uint32_t j = 0; j < window.count; ++j) sum += weight[j] * value[j];
        sum = std::max(sum, 1e-300);
        log_likelihood[i++] = std::log(sum) + window.log_scale;
        for (std::uint32_t j = 0; j < window.count; ++j)
          share[index][window.first_node + j] += weight[j] * value[j] / sum;
      }
    });
    if (iteration == kIterations) break;
    std::fill(weights.begin(), weights.end(), 0.0);
    for (const std::vector<double>& of_chunk : share) {
      for (std::size_t j = 0; j < nodes; ++j) weights[j] += of_chunk[j] / static_cast<double>(size());
    }
    // Keeps weights above 0, because a weight of 0 could not grow at another noise level.
    for (double& weight : weights) weight = std::max(weight, 1e-12);
  }
  return log_likelihood;
}

std::vector<double> StillLikelihood::EchoPower(double noise_db, const std::vector<double>& weights) const {
  const std::vector<Chunk> chunks = Chunks(noise_db);
  std::vector<double> power(size());
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t index) {
    std::size_t i = index * kChunk;
    for (const Window& window : chunks[index].windows) {
      double sum = 0.0;
      double mean = 0.0;
      for (std::uint32_t j = 0; j < window.count; ++j) {
        const std::uint32_t node = window.first_node + j;
        const double chance = weights[node] * chunks[index].values[window.start + j];
        sum += chance;
        mean += chance * amplitude_[node] * amplitude_[node];
      }
      power[i] = mean / sum * PowerFromDb(noise_db + shapes_db_[shape_index_[i]]);
      ++i;
    }
  });
  return power;
}

}  // namespace sonarcal::calib
