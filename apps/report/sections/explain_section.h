// An ablation study (apps/workflow/explain.h) as sections of a report, and as text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "apps/workflow/explain.h"

namespace sonarcal::report {

// Name of a step for display, such as "beam and pulse".
std::string_view TitleOf(calib::ExplainedPart part);

// Options for the presentation of an ablation study.
struct ExplanationPresentation {
  std::string title = {};  // name of the recording, shown with every picture; empty: none
  bool about = false;      // adds a waterfall of the error around the object
  bool apart = false;      // evaluates the held-out frames one by one, not together
  bool synthetic = false;  // the recording is simulated
  // from the preparation, such as a search that ended at the end of its range
  std::vector<std::string> warnings = {};
  std::vector<std::string> caveats = {};  // assumptions and limits, one sentence each
};

// Adds a section with the waterfall, its table, and the steps that were left out. If frames are evaluated one
// by one, there are several waterfalls and tables.
void AddWaterfall(HtmlReport& report, const workflow::ExplainedRecording& explained,
                  const ExplanationPresentation& presentation = {});

// Adds a section on the causes of bright pixels: shares in a sentence, and maps.
void AddCauses(HtmlReport& report, const workflow::ExplainedRecording& explained,
               const ExplanationPresentation& presentation = {});

// Returns a sentence such as "of the bright cells 71 % show floor, 12 % ghost by wall, ...": causes in
// descending order, those below 0.5 % together.
std::string CauseSentence(const workflow::ExplainedRecording& explained);

// Returns reasons to doubt the study, one sentence each: values and searches at the end of their range, and
// steps whose held-out likelihood and held-out error disagree.
std::vector<std::string> WarningsOf(const workflow::ExplainedRecording& explained,
                                    const ExplanationPresentation& presentation);

// Returns the object of explain.json.
nlohmann::ordered_json ExplanationJson(const workflow::ExplainedRecording& explained,
                                       const ExplanationPresentation& presentation = {});

// Returns text for a terminal.
std::string ExplanationText(const workflow::ExplainedRecording& explained,
                            const ExplanationPresentation& presentation = {});

}  // namespace sonarcal::report
