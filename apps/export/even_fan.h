// A sonar's beams as other simulators have them: evenly spaced, centred ahead.
#pragma once

#include <string>

#include "apps/export/export_account.h"

namespace sonarcal::exporting {

struct EvenFan {
  int beams = 0;
  double first_deg = 0.0;  // centres of the outer beams, positive to the right
  double last_deg = 0.0;
  double field_deg = 0.0;      // from outer edge to outer edge
  double elevation_deg = 0.0;  // half-power width of the beam: the parameters' own, else the sonar's
  double centre_deg = 0.0;     // where the middle of the field lies; others look straight ahead
  double worst_deg = 0.0;      // farthest that a beam lies from where it would if evenly spaced

  double spacing_deg() const { return field_deg / beams; }
  bool IsEven() const;     // to a thousandth of a beam
  bool IsCentred() const;  // likewise
};

EvenFan EvenFanOf(const ExportSource& source);

// Says what becomes of sonar.beam_azimuth_deg, where `target` is what sets the field of view and the number
// of beams: exported where the beams are even and centred, else approximated. `also` is a further reason why
// it is approximated.
void AccountForBeams(const EvenFan& fan, const std::string& target, ExportAccount& account,
                     const std::string& also = "");

}  // namespace sonarcal::exporting
