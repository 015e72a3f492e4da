// What `reproduce` compares, a row a way to simulate: the same rows in the terminal, in the report and in
// metrics.json.
#pragma once

#include <string>
#include <vector>

#include "apps/reproduce/bomb_comparison.h"
#include "apps/reproduce/tank_comparison.h"

namespace sonarcal::reproduce {

struct SummaryRow {
  std::string key;   // in metrics.json
  std::string name;  // for people
  const metrics::MetricsReport* metrics = nullptr;
  bool strong = false;  // a fitted model as it is to be read
  bool muted = false;   // no simulation of a model: what to read the others beside
};

// Whether a fit has no warnings. One that has is not printed in bold.
bool IsSound(const workflow::RecordingFit& fit);

// A row's name for a fit of the paper's model.
std::string FittedName(const workflow::RecordingFit& fit);

// On the held-out frames of the synthetic tank.
std::vector<SummaryRow> TankRows(const TankComparison& tank);

// On the held-out frame of the bomb, with outline and pose found beforehand; a fit without a usable solution
// has no rows.
std::vector<SummaryRow> BombRows(const BombComparison& bomb);

// The same with the plain outline and the pose found by the search.
std::vector<SummaryRow> SearchedBombRows(const BombComparison& bomb);

// {key: {"name", "iou", "ns_over_nr", "na_over_ns", "na_over_nr", "intensity_error": {"union", "overlap",
// "whole"}}} of the polar images, as JSON text.
std::string SummaryJson(const std::vector<SummaryRow>& rows);

}  // namespace sonarcal::reproduce
