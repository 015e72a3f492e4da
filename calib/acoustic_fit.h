// Fits the acoustic model's parameters to recorded polar images by maximum likelihood (Ceres).
//
// The likelihood is that of speckle about the mean power of every pixel (calib/acoustic_frame_model.h); the
// rest is calib/fit.h: several starts, sigmas from a sandwich over blocks of pixels, and what the data cannot
// tell held and named. Frames are given as gathered echoes: a fit casts no ray.
#pragma once

#include <string>
#include <vector>

#include "calib/acoustic_frame_model.h"
#include "calib/fit.h"

namespace sonarcal {

// What a fit of the acoustic model frees where nobody says: curves and noise floor. The gauge: gain and
// source level stay, so that the materials carry the level; beam and pulse stay as the sonar's own.
std::vector<std::string> AcousticFreeByDefault();

// Level of the noise floor in the darkest fifth of the recorded pixels, dB: where a fit starts.
double NoiseStartDb(const std::vector<AcousticFrame>& frames, double looks);

// `initial` must name a noise level. Throws DataError as FitPaperModel does.
FitResult FitAcousticModel(const std::vector<AcousticFrame>& frames, const SonarModel& sonar,
                           double absorption_db_per_m, const std::vector<std::string>& material_names,
                           const ParameterSet& initial, const FitConfig& config,
                           const FitOptions& options = {});

}  // namespace sonarcal
