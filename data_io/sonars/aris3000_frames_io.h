// Frames of a bomb in a test basin, ARIS Explorer 3000 at 3.0 MHz, recovered from the pictures published with
// the dataset of github.com/dfki-ric/uxo-dataset2024 (no licence stated: for evaluation only).
//
// A folder with
//   frame_NNNN_128x780.png            8-bit grey, 780 ranges (row 0 nearest) x 128 beams
//   beam_table_ARIS3000_128.csv       beam,center_deg,left_deg,right_deg (optional: the SDK's table else)
//
// Each picture had been stretched over its own grey levels, grey = floor(k * 255 / N) of the count k. N
// follows from the levels that occur; the stretched grey of the largest N is kept (full scale 255), so
// db_span is N counts of 80/255 dB. Where N does not show, db_span is unknown.
//
// The data set also has fan pictures of the same window, such as other_pose_fan.png: there grey is the count,
// so db_span is 80 dB. Where the fan lies in such a picture has to be given.
//
// Which side is which: column 0 is beam 0 of the table, and its angle is taken as the azimuth. The SDK calls
// beam 0 the right-most, and the script that drew the pictures flips them, so the frames probably show the
// scene mirrored left to right. The object is a body of revolution: a mirrored pose explains a mirrored
// frame. Neither range window (inferred from the sensor's timing) nor pose is recorded; notes say so.
#pragma once

#include <filesystem>
#include <memory>

#include "core/types/recording.h"
#include "data_io/pictures/fan_geometry.h"

namespace sonarcal::data_io {

// True where `path` is such a folder. Reads no pixel.
bool IsAris3000Frames(const std::filesystem::path& path);

// Throws DataError where `path` is no such folder, or its beam table or a picture is damaged.
std::unique_ptr<RecordingSource> OpenAris3000Frames(const std::filesystem::path& path);

// A fan picture, resampled to the beams and ranges of the frames by nearest neighbour. ReadFrame throws
// DataError where the picture is damaged or does not hold the whole fan.
std::unique_ptr<RecordingSource> OpenAris3000FanPicture(const std::filesystem::path& picture,
                                                        const FanGeometry& fan);

}  // namespace sonarcal::data_io
