#include "sim/acoustic/azimuth_filter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "sim/rays/row_math/sums.h"

namespace sonarcal::sim {

template <typename T>
AzimuthFilter<T>::AzimuthFilter(const std::vector<ResponseWindow>& windows)
    : beams_(static_cast<int>(windows.size())) {
  const auto end = [](const ResponseWindow& window) {
    return static_cast<std::size_t>(window.first) + window.weight.size();
  };
  for (int beam = 0; beam < beams_; beam += 2) {
    const ResponseWindow& one = windows[beam];
    const ResponseWindow& other = windows[std::min(beam + 1, beams_ - 1)];
    BeamPair& pair = pairs_.emplace_back();
    pair.first_col = std::min(one.first, other.first);
    for (const auto& [window, weight] :
         {std::pair(&one, &pair.weight[0]), std::pair(&other, &pair.weight[1])}) {
      weight->resize(std::max(end(one), end(other)) - pair.first_col);
      std::transform(window->weight.begin(), window->weight.end(),
                     weight->begin() + (window->first - pair.first_col),
                     [](double value) { return static_cast<T>(value); });
    }
  }
}

// A few bins at a time, because they share the loads of the weights.
template <typename T>
Grid<T> AzimuthFilter<T>::Filter(const Grid<T>& in_bins) const {
  constexpr int kTogether = row_math::kDots;
  Grid<T> out(in_bins.rows(), beams_);
  const int groups = (in_bins.rows() + kTogether - 1) / kTogether;
  tbb::parallel_for(tbb::blocked_range<int>(0, groups, 2), [&](const tbb::blocked_range<int>& range) {
    for (int first = range.begin() * kTogether; first < range.end() * kTogether; first += kTogether) {
      const int last = std::min(first + kTogether, in_bins.rows()) - 1;
      std::array<const T*, kTogether> rows;
      bool silent = true;
      for (int k = 0; k < kTogether; ++k) {
        const auto row = in_bins.row(std::min(first + k, last));
        rows[k] = row.data();
        silent = silent && std::all_of(row.begin(), row.end(), [](T value) { return value == T(0); });
      }
      if (silent) continue;
      for (int pair = 0; pair < static_cast<int>(pairs_.size()); ++pair) {
        const BeamPair& beams = pairs_[pair];
        const std::array weights{beams.weight[0].data(), beams.weight[1].data()};
        std::array<const T*, kTogether> from;
        for (int k = 0; k < kTogether; ++k) from[k] = rows[k] + beams.first_col;
        std::array<T, 2 * kTogether> sums;
        row_math::Dots(weights.data(), from.data(), static_cast<int>(beams.weight[0].size()), sums.data());
        for (int beam = 2 * pair; beam < std::min(2 * pair + 2, beams_); ++beam) {
          const int of_beam = (beam - 2 * pair) * kTogether;
          for (int bin = first; bin <= last; ++bin) out(bin, beam) = sums[of_beam + bin - first];
        }
      }
    }
  });
  return out;
}

template class AzimuthFilter<float>;
template class AzimuthFilter<double>;

}  // namespace sonarcal::sim
