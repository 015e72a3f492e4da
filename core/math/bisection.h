// Place at which a condition changes, by repeated halving of an interval.
#pragma once

namespace sonarcal {

// Returns the place between `low` and `high` up to which `is_below` holds, to 2^-60 of the interval. It must
// hold from `low` up to that place and not beyond. If it holds nowhere the result is `low`; if it holds
// everywhere, `high`.
template <typename Condition>
double Bisection(double low, double high, const Condition& is_below) {
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_below(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace sonarcal
