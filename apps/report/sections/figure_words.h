// Format of the figures of a comparison, for all sections of a report.
#pragma once

#include <optional>
#include <string>

#include "metrics/aggregate.h"
#include "metrics/figures.h"
#include "metrics/measures/intensity.h"
#include "metrics/noise_floor.h"

namespace sonarcal::report {

// Three decimals; a dash if there is no value.
std::string FigureText(const std::optional<double>& value);

// Text such as "0.412 to 0.530"; a dash if there is none.
std::string IntervalText(const metrics::Statistic& statistic);

// Text such as "m", "dB", "bins", "part of full scale"; empty for a pure number.
std::string UnitText(metrics::FigureUnit unit);

// Text such as "PSNR, whole (dB)".
std::string LabelWithUnit(const metrics::Figure& figure);

// Text such as "the union of the two object regions".
std::string DomainText(metrics::IntensityDomain domain);

// Sentence about the source of the noise floor; empty if there is none.
std::string FloorNote(const metrics::NoiseFloor& floor);

}  // namespace sonarcal::report
