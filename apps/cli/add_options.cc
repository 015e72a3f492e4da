#include "apps/cli/add_options.h"

#include <algorithm>

#include "core/types/parse_number.h"
#include "core/types/printable.h"
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
  value = {.value = data_io::ReadMask(text), .file = text};
  return true;
}

}  // namespace sonarcal

namespace sonarcal::cli {

std::string OptionFlag(std::string_view name) {
  std::string flag = "--" + std::string(name);
  std::ranges::replace(flag, '_', '-');
  return flag;
}

CLI::Validator Within(double least, double most) {
  return {[least, most](const std::string& text) {
            double number = 0.0;
            if (ParseNumber(text, number) && number >= least && number <= most) return std::string();
            return fmt::format("is {}, expected {:g} .. {:g}", Printable(text), least, most);
          },
          ""};
}

CLI::Option* AddFrames(CLI::App& command, FrameList& frames, const std::string& what) {
  return AddOption(
      command,
      {.name = "frames",
       .help = what + ", counted from 0: A:B from A up to, but not including, B; also single frames, "
                      "A: and :B",
       .by_default = "all"},
      frames);
}

}  // namespace sonarcal::cli
