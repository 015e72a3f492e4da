// How figures of a comparison are written in a report, once for all its sections.
#pragma once

#include <optional>
#include <string>

#include "metrics/aggregate.h"
#include "metrics/figures.h"
#include "metrics/measures/intensity.h"
#include "metrics/noise_floor.h"

namespace sonarcal::report {

// Three decimals; a dash where there is no value.
std::string FigureText(const std::optional<double>& value);

// "0.412 to 0.530"; a dash where there is none.
std::string IntervalText(const metrics::Statistic& statistic);

// "m", "dB", "bins", "part of full scale" ...; empty for a pure number.
std::string UnitText(metrics::FigureUnit unit);

// "the union of the two object regions" and its like.
std::string DomainText(metrics::IntensityDomain domain);

// Where the floor beside the figures comes from, in a sentence; empty where there is none.
std::string FloorNote(const metrics::NoiseFloor& floor);

}  // namespace sonarcal::report
