// Grey pictures in binary PGM ("P5") of 8 bits: blanks or '#' comments between width, height and max
// value, one blank, then the rows from the top. OpenCV does not read them here because it prints the cause of
// a failure to the terminal without returning it.
#pragma once

#include <filesystem>

#include "core/types/image.h"

namespace sonarcal::data_io {

// Returns the stored numbers. Throws DataError naming the file if it is not a PGM of `rows` x `cols` and up
// to 255, or if pixels are missing.
Grid<float> ReadPgm(const std::filesystem::path& file, int rows, int cols);

}  // namespace sonarcal::data_io
