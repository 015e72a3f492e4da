#include "apps/python/bind_options.h"

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "apps/python/bindings.h"
#include "apps/workflow/calibration/calibrate.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/explain.h"
#include "apps/workflow/fit.h"
#include "apps/workflow/locate.h"
#include "apps/workflow/noise/judge_noise.h"
#include "apps/workflow/simulate.h"
#include "apps/workflow/task/recording_transfer.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

// "; 1 to 100"; empty without limits.
std::string Limits(const OptionInfo& info) {
  const std::string text = LimitsText(info);
  constexpr std::string_view kExpected = ", expected ";
  return text.empty() ? text : "; " + text.substr(kExpected.size());
}

template <typename Options>
void AddFlags(std::set<std::string>& names) {
  const Options by_default{};
  Options::Visit(by_default, [&](const OptionInfo& info, const auto&) { names.insert(info.name); });
}

std::set<std::string> KeywordNames() {
  std::set<std::string> names = {"frames", "scene", "train_masks", "test_masks"};
  AddFlags<workflow::SimulateOptions>(names);
  AddFlags<workflow::CompareOptions>(names);
  AddFlags<workflow::FitOptions>(names);
  AddFlags<workflow::ExplainOptions>(names);
  AddFlags<workflow::CalibrateOptions>(names);
  AddFlags<workflow::JudgeNoiseOptions>(names);
  AddFlags<workflow::LocateOptions>(names);
  AddFlags<workflow::TransferOptions>(names);
  return names;
}

}  // namespace

std::string OptionDescription::Text() const {
  const std::string default_text =
      info.by_default.empty() ? py::repr(by_default).cast<std::string>() : info.by_default;
  return fmt::format("{}. {}{}; default: {}.", info.help, type, Limits(info), default_text);
}

py::dict OptionDescription::Dict() const {
  py::dict dict;
  dict["name"] = info.name;
  dict["help"] = info.help;
  dict["type"] = type;
  dict["unit"] = info.unit;
  dict["default"] = by_default;
  dict["by_default"] = info.by_default;
  dict["min"] = std::isfinite(info.min) ? py::object(py::float_(info.min)) : py::none();
  dict["max"] = std::isfinite(info.max) ? py::object(py::float_(info.max)) : py::none();
  dict["text"] = Text();
  dict["input"] = input;
  dict["output"] = output;
  return dict;
}

void RaiseUnknownOption(const std::string& class_name, const std::string& name, const py::list& names) {
  const py::list near = py::module_::import("difflib").attr("get_close_matches")(name, names, 1);
  const std::string hint =
      near.empty() ? "" : fmt::format("; did you mean '{}'?", near[0].cast<std::string>());
  throw py::type_error(fmt::format("{}: '{}' is no option{}", class_name, name, hint));
}

std::string WithKeywords(const std::string& sentence) {
  static const std::set<std::string> kNames = KeywordNames();
  static const std::regex kFlag("--([a-z]+(-[a-z]+)*)");
  std::string text;
  auto rest = sentence.begin();
  for (std::sregex_iterator match(sentence.begin(), sentence.end(), kFlag), end; match != end; ++match) {
    std::string name = (*match)[1];
    std::ranges::replace(name, '-', '_');
    text.append(rest, (*match)[0].first);
    text += kNames.contains(name) ? name : std::string((*match)[0]);
    rest = (*match)[0].second;
  }
  return text.append(rest, sentence.end());
}

void BindAllOptions(py::module_& module) {
  BindOptions<workflow::RayOptions>(module, "RayOptions", "Options of residual_view(): rays.");
  BindOptions<workflow::ComparisonOptions>(
      module, "ComparisonOptions", "Options of segment(): how the object is found, which pixels count.");
  BindOptions<workflow::SimulateOptions>(module, "SimulateOptions", "Options of simulate().");
  BindOptions<workflow::CompareOptions>(module, "CompareOptions",
                                        "Options of compare() and compare_images().");
  BindOptions<workflow::FitOptions>(module, "FitOptions", "Options of fit().");
  BindOptions<workflow::CalibrateOptions>(module, "CalibrateOptions", "Options of calibrate().");
  BindOptions<workflow::JudgeNoiseOptions>(module, "JudgeNoiseOptions", "Options of judge_noise().");
  BindOptions<workflow::LocateOptions>(module, "LocateOptions", "Options of locate().");
  BindOptions<workflow::ExplainOptions>(module, "ExplainOptions", "Options of explain().");
  BindOptions<workflow::TransferOptions>(module, "TransferOptions", "Options of transfer().");
}

}  // namespace sonarcal::python
