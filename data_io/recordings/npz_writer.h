// Recordings as NumPy archives (.npz): a zip of arrays that numpy.load reads.
//
//   with numpy.load("dive.npz") as dive:
//       dive["images"]            frames x range bins x beams: uint8, uint16 or float32
//       dive["range_m"]           centres of the range bins
//       dive["beam_azimuth_deg"]  centres of the beams, leftmost first, positive to the right
//       dive["time_s"]            per frame; NaN if unknown
//       dive["world_from_sonar"]  frames x 4 x 4; NaN if unknown
//       dive["valid"]             range bins x beams, bool: samples that hold a measurement
//       json.loads(dive["recording"].item())  content of recording.json without the frames' files
//
// Grey values are rounded to uint8 or uint16. Images are float32 for other quantities, and if the full scale
// of the grey values is not whole, at most 1 or above 65535.
#pragma once

#include <filesystem>
#include <functional>

#include "core/types/recording.h"

namespace sonarcal::data_io {

// Writes `file` frame by frame, so a recording of any length needs constant memory. Throws DataError if
// frames differ in their axes or scale, a value is not finite or, if grey, outside 0 .. full_scale, or the
// file cannot be written.
void WriteNpz(const RecordingSource& recording, const std::filesystem::path& file,
              const std::function<void(int frames_done)>& progress = {});

}  // namespace sonarcal::data_io
