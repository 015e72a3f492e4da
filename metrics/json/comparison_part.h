// Part of a comparison: the measurements of some frames of a long recording, as a file. Parts that several
// programs measured are merged to what one program would have measured: counts, sums per frame and grey
// levels are exactly the same.
//
// The file serves the program that wrote it, on machines of one kind: numbers are stored as in memory, behind
// their SHA-256. Another version refuses it, and any version refuses a damaged one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "metrics/compare.h"
#include "metrics/measures/residuals.h"

namespace sonarcal::metrics {

struct ComparisonPart {
  std::string compared;   // recording and options, as text; the same in all parts of a comparison
  std::string simulated;  // path of the recording that holds these simulated frames
  std::vector<FrameMetrics> frames = {};  // with the counts of the sweep, without levels and masks
  FrameLevels levels = {};                // pooled
  ResidualCollector residuals = {};
  std::vector<ResidualTable> residuals_by_scene = {};
  std::vector<std::string> notes = {};

  // Adds a frame that still holds its levels.
  void Add(const FrameMetrics& frame);
};

std::string ComparisonPartBytes(const ComparisonPart& part);

// Throws DataError that begins with `name` if the bytes are no part, a damaged one, or one of another
// version.
ComparisonPart ParseComparisonPart(std::string_view bytes, const std::string& name);

// Merges parts in the order of their frames. Throws DataError if they are of different comparisons or if a
// frame is in two of them.
ComparisonPart MergedParts(std::vector<ComparisonPart> parts);

}  // namespace sonarcal::metrics
