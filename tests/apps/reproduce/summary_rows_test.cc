#include "apps/reproduce/summary_rows.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sonarcal::reproduce {
namespace {

SummaryRow RowOf(const std::vector<SummaryRow>& rows, const std::string& key) {
  for (const SummaryRow& row : rows) {
    if (row.key == key) return row;
  }
  ADD_FAILURE() << "no row " << key;
  return {};
}

void ExpectAFittedRow(const SummaryRow& row, bool sound) {
  EXPECT_EQ(row.strong, sound) << row.name;
  EXPECT_EQ(row.name.find("(doubtful)") == std::string::npos, sound) << row.name;
}

TEST(SummaryRows, ADoubtfulFitOfEitherModelIsNamedSoAndNotBold) {
  for (const bool paper_is_sound : {false, true}) {
    for (const bool acoustic_is_sound : {false, true}) {
      workflow::RecordingFit paper;
      paper.fit.usable = true;
      workflow::RecordingFit acoustic = paper;
      if (!paper_is_sound) paper.fit.report.warnings = {"the fit is degenerate"};
      if (!acoustic_is_sound) acoustic.fit.report.warnings = {"the fit is degenerate"};
      SyntheticComparison synthetic;
      synthetic.fit = paper;
      synthetic.acoustic = acoustic;
      synthetic.acoustic.sample_after.emplace();
      const std::vector<SummaryRow> of_synthetic = SyntheticRows(synthetic);
      ExpectAFittedRow(RowOf(of_synthetic, "paper_fitted"), paper_is_sound);
      ExpectAFittedRow(RowOf(of_synthetic, "acoustic_expected"), acoustic_is_sound);
      ExpectAFittedRow(RowOf(of_synthetic, "acoustic_sample"), acoustic_is_sound);
      TargetComparison target;
      target.paper = paper;
      target.fitted.acoustic = acoustic;
      const std::vector<SummaryRow> of_target = TargetRows(target);
      ExpectAFittedRow(RowOf(of_target, "paper_fitted"), paper_is_sound);
      ExpectAFittedRow(RowOf(of_target, "acoustic_expected"), acoustic_is_sound);
      ExpectAFittedRow(RowOf(of_target, "acoustic_samples"), acoustic_is_sound);
    }
  }
}

}  // namespace
}  // namespace sonarcal::reproduce
