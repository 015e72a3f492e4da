// Fitted materials as named materials: the curve of a fit with its standard errors, for the next fit.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/materials/named_materials.h"
#include "core/types/recording.h"

namespace sonarcal::workflow {

// Reads the materials of `fit.json` that were fitted. The centre is the fitted value, the spread its standard
// error. A value that the data do not determine, or that ends at a bound, has the spread of its prior, and
// the comment names it. `recording`: the one that was fitted, for the band and the origin. Throws DataError
// if the file is no result of a fit, if no material was fitted, or if a curve was fitted only in part.
std::vector<NamedMaterial> FittedMaterials(const std::filesystem::path& fit_json,
                                           const RecordingInfo& recording);

}  // namespace sonarcal::workflow
