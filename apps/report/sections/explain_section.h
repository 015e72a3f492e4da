// An explained recording (apps/workflow/explain.h) as sections of a report, and in words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "apps/workflow/explain.h"

namespace sonarcal::report {

// What a step adds, for people: "beam and pulse".
std::string_view TitleOf(calib::ExplainedPart part);

// How an explanation is told.
struct ExplanationTelling {
  std::string title = {};                  // of the recording, said wherever a picture is shown; empty: none
  bool about = false;                      // a waterfall of what lies about the object, too
  bool apart = false;                      // held-out frames judge one by one, not together
  bool synthetic = false;                  // a simulation made the recording
  std::vector<std::string> warnings = {};  // of how it was prepared, such as a search that ended at its end
  std::vector<std::string> caveats = {};   // what was assumed and what figures do not show, a sentence each
};

// The waterfall, its table, and what was left out; several of the first two where frames judge apart. Adds a
// section.
void AddWaterfall(HtmlReport& report, const workflow::ExplainedRecording& explained,
                  const ExplanationTelling& telling = {});

// Where the bright cells come from: shares in words, maps. Adds a section.
void AddCauses(HtmlReport& report, const workflow::ExplainedRecording& explained,
               const ExplanationTelling& telling = {});

// "of the bright cells 71 % show floor, 12 % ghost by wall, ...": causes by their share, those below half a
// percent together.
std::string CauseSentence(const workflow::ExplainedRecording& explained);

// Reasons to doubt the explanation, one sentence each: values and searches that ended at the end of their
// range, and steps whose held-out likelihood and held-out error disagree.
std::vector<std::string> WarningsOf(const workflow::ExplainedRecording& explained,
                                    const ExplanationTelling& telling);

// The object of explain.json.
nlohmann::ordered_json ExplanationJson(const workflow::ExplainedRecording& explained,
                                       const ExplanationTelling& telling = {});

// For a terminal.
std::string ExplanationText(const workflow::ExplainedRecording& explained,
                            const ExplanationTelling& telling = {});

}  // namespace sonarcal::report
