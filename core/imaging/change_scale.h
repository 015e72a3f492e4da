// Change of an image to another full scale.
#pragma once

#include "core/types/image.h"

namespace sonarcal {

// Multiplies the grey values so that `scale` holds for the image. Does not round.
inline void ChangeScale(const ImageScale& scale, PolarImage& image) {
  const double factor = scale.full_scale / image.scale.full_scale;
  for (float& value : image.value.values()) value = static_cast<float>(value * factor);
  image.scale = scale;
}

}  // namespace sonarcal
