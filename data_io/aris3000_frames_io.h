// Frames of a bomb in a test basin, ARIS Explorer 3000 at 3.0 MHz, recovered from the pictures published with
// the dataset of github.com/dfki-ric/uxo-dataset2024 (no licence stated: for evaluation only).
//
// A folder with
//   frame_NNNN_128x780.png            8-bit grey, 780 ranges (row 0 nearest) x 128 beams
//   beam_table_ARIS3000_128.csv       beam,center_deg,left_deg,right_deg (optional: the SDK's table else)
//   other_pose_fan.png                the same object from another pose, as a fan picture (opened by itself)
//
// Frames: each picture had been stretched over its own grey levels, grey = floor(k * 255 / 97) of the count
// k; the stretched grey is kept (full scale 255), so db_span is 97 counts of 80/255 dB. Fan picture: grey is
// the count, so db_span is 80 dB; it is resampled to the beams and ranges of the frames, nearest neighbour.
//
// Which side is which: column 0 is beam 0 of the table, and its angle is taken as the azimuth. The SDK calls
// beam 0 the right-most, and the script that drew the pictures flips them, so the frames probably show the
// scene mirrored left to right. The object is a body of revolution: a mirrored pose explains a mirrored
// frame. Neither range window (inferred from the sensor's timing) nor pose is recorded; notes say so.
#pragma once

#include <filesystem>
#include <memory>

#include "data_io/types/recording.h"

namespace sonarcal {

// True where `path` is such a folder, or such a fan picture (told by its size). Reads no pixel.
bool IsAris3000Frames(const std::filesystem::path& path);

// Opens such a folder or such a fan picture. Throws DataError where it is neither, or its beam table is
// damaged; ReadFrame throws where a picture is.
std::unique_ptr<RecordingSource> OpenAris3000Frames(const std::filesystem::path& path);

}  // namespace sonarcal
