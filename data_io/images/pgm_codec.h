// Grey pictures in binary PGM ("P5") of 8 bits: blanks or '#' comments between width, height and the largest
// value, one blank, then the rows from the top.
#pragma once

#include <filesystem>

#include "core/types/image.h"

namespace sonarcal::data_io {

// The stored numbers. Throws DataError naming the file where it is no PGM of `rows` x `cols` and up to 255,
// or its pixels are not all there.
Grid<float> ReadPgm(const std::filesystem::path& file, int rows, int cols);

}  // namespace sonarcal::data_io
