// Round numbers for the marks of an axis.
#pragma once

#include <vector>

namespace sonarcal::report {

// Returns the smallest of 1, 2, 5 x 10^k that gives at most `count` steps over `span`.
double NiceStep(double span, int count);

// Number of decimals that show every multiple of the step.
int DecimalsOf(double step);

// Multiples of the step from `min` to `max`, both included to within rounding.
std::vector<double> TicksWithin(double min, double max, double step);

}  // namespace sonarcal::report
