// Beams of a sonar in the form of other simulators: evenly spaced, centred ahead.
#pragma once

#include <string>

#include "apps/export/export_account.h"

namespace sonarcal::exporting {

struct EvenFan {
  int beams = 0;
  double first_deg = 0.0;  // centres of the outer beams, positive to the right
  double last_deg = 0.0;
  double field_deg = 0.0;      // from outer edge to outer edge
  double elevation_deg = 0.0;  // half-power width of the beam: that of the parameters, else that of the sonar
  double centre_deg = 0.0;     // middle of the field; 0 in other simulators
  double worst_deg = 0.0;      // largest distance of a beam from its place in even spacing

  double spacing_deg() const { return field_deg / beams; }
  bool IsEven() const;     // to a thousandth of a beam
  bool IsCentred() const;  // to a thousandth of a beam
};

EvenFan EvenFanOf(const ExportSource& source);

// Accounts for sonar.beam_azimuth_deg. `target` names the field of view and the number of beams there.
// Exported if the beams are even and centred, else approximated. `also`: another reason for an approximation.
void AccountForBeams(const EvenFan& fan, const std::string& target, ExportAccount& account,
                     const std::string& also = "");

}  // namespace sonarcal::exporting
