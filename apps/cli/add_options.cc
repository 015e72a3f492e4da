#include "apps/cli/add_options.h"

#include <algorithm>
#include <cmath>

#include "data_io/files/file_bytes.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal {
namespace {

constexpr std::size_t kMaxTextBytes = std::size_t{1} << 30;

}  // namespace

bool OptionText<FromFile<ParameterSet>>::Parse(const std::string& text, FromFile<ParameterSet>& value) {
  value = {.value = data_io::ReadParameters(text), .file = text};
  return true;
}

bool OptionText<FromFile<calib::FitConfig>>::Parse(const std::string& text,
                                                   FromFile<calib::FitConfig>& value) {
  value = {.value = calib::ReadFitConfig(text), .file = text};
  return true;
}

bool OptionText<FromFile<std::string>>::Parse(const std::string& text, FromFile<std::string>& value) {
  value = {.value = data_io::ReadFileBytes(text, kMaxTextBytes), .file = text};
  return true;
}

bool OptionText<FromFile<Mask>>::Parse(const std::string& text, FromFile<Mask>& value) {
  const data_io::ImageFile image(text);
  const Grid<float> grey = image.DecodeGrey();
  Mask mask(grey.rows(), grey.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) mask.values()[i] = grey.values()[i] > 0.0F ? 1 : 0;
  value = {.value = std::move(mask), .file = text};
  return true;
}

}  // namespace sonarcal

namespace sonarcal::cli {
namespace internal {

std::string RangeText(const OptionInfo& info) {
  const bool has_min = std::isfinite(info.min);
  const bool has_max = std::isfinite(info.max);
  if (has_min && has_max) return fmt::format(", expected {:g} to {:g}", info.min, info.max);
  if (has_min) return fmt::format(", expected {:g} or more", info.min);
  return has_max ? fmt::format(", expected {:g} or less", info.max) : std::string();
}

}  // namespace internal

std::string OptionFlag(std::string_view name) {
  std::string flag = "--" + std::string(name);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

}  // namespace sonarcal::cli
