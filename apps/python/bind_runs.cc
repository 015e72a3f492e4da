#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <exception>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands/compare_command.h"
#include "apps/commands/fit_command.h"
#include "apps/commands/simulate_command.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/python/words.h"
#include "data_io/parameters/parameters_io.h"
#include "metrics/segmentation/segmentation.h"
#include "sim/gathered/empty_frames.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

using Words = std::vector<std::string>;
using Recording = std::shared_ptr<RecordingSource>;

constexpr const char* kGiven = "the parameters given";  // for messages, where a command names a file

std::vector<data_io::TimedPose> Timed(const std::vector<Pose>& poses,
                                      const std::vector<std::optional<double>>& times_s) {
  std::vector<data_io::TimedPose> timed;
  for (std::size_t i = 0; i < poses.size(); ++i)
    timed.push_back({.time_s = i < times_s.size() ? times_s[i] : std::nullopt, .world_from_sonar = poses[i]});
  return timed;
}

Recording Simulate(const Scene& scene, const workflow::SonarChoice& sonar, const std::string& params,
                   const std::vector<Pose>& poses, const std::vector<std::optional<double>>& times_s,
                   const std::string& scene_path, const Words& words, py::object progress, py::object say) {
  const Listener listener(std::move(progress), std::move(say));
  const py::gil_scoped_release release;
  commands::SimulateOptions options;
  CLI::App command;
  commands::AddSimulateOptions(&command, &options);
  ParseWords(command, words);
  if (poses.empty()) throw DataError("poses: none, expected one or more");
  const workflow::ThreadLimit threads(options.rays.threads);
  const commands::ResolvedSimulation resolved =
      commands::ResolveSimulation(options, sonar, data_io::ParseParameters(params, kGiven));
  const sim::Simulator simulator(scene, sonar.sonar, resolved.simulation);
  for (const std::string& sentence : commands::SimulationCaveats(options, simulator, resolved))
    listener.Say(sentence);
  const std::vector<int> empty = sim::PosesThatSeeNothing(simulator, poses);
  if (!empty.empty()) listener.Say(sim::EmptyFramesWarning(simulator, poses, empty));
  const int frames_in_all = static_cast<int>(poses.size());
  return workflow::SimulateRecording(
      simulator, Timed(poses, times_s), resolved.parameters, scene_path,
      [&](int done) { listener.Progress("Simulating", done, frames_in_all); }, options.expected);
}

std::string Compare(const RecordingSource& real, const RecordingSource& simulated, const Words& words,
                    py::object progress) {
  const Listener listener(std::move(progress), py::none());
  const py::gil_scoped_release release;
  commands::CompareCommandOptions options;
  CLI::App command;
  commands::AddCompareOptions(&command, &options);
  ParseWords(command, words);
  options.pictures = 0;
  options.common.quiet = true;
  const commands::Comparison comparison = commands::MeasureComparison(
      options, real, simulated, {},
      [&](int done, int in_all) { listener.Progress("Comparing", done, in_all); });
  return metrics::MetricsJson(comparison.metrics);
}

struct Fitted {
  bool usable = false;
  std::string report;      // fit.json
  std::string parameters;  // params.json; empty where not usable
  std::vector<Pose> poses;
};

Fitted Fit(const RecordingSource& recording, const Scene& scene, const std::string& params,
           const Words& words, py::object progress, py::object say) {
  const Listener listener(std::move(progress), std::move(say));
  const py::gil_scoped_release release;
  commands::FitCommandOptions options;
  CLI::App command;
  commands::AddFitOptions(&command, &options);
  ParseWords(command, words);
  const workflow::ThreadLimit threads(options.rays.threads);
  const ParameterSet initial = data_io::ParseParameters(params, kGiven);
  for (const std::string& sentence : workflow::MirrorCaveats(initial, scene.material_names))
    listener.Say(sentence);
  // Ceres is not written to be left by an exception: it is asked to stop, and the exception thrown after it.
  std::exception_ptr thrown;
  int iterations = 0;
  const auto stop = [&] {
    if (thrown) return true;
    try {
      listener.Progress("Fitting", ++iterations, 0);
    } catch (...) {
      thrown = std::current_exception();
    }
    return thrown != nullptr;
  };
  workflow::RecordingFit fit;
  try {
    fit = commands::FitAsAsked(
        options, recording, scene, commands::ResolveFitConfig(options, initial, scene), initial,
        {.say = [&](const std::string& sentence) { listener.Say(sentence); },
         .on_trace = [&](int done, int in_all) { listener.Progress("Tracing", done, in_all); },
         .stop = stop});
  } catch (const calib::FitStopped&) {
    std::rethrow_exception(thrown);
  }
  Fitted fitted{.usable = fit.fit.usable, .report = commands::FitJson(fit), .parameters = {}, .poses = {}};
  if (fit.fit.usable) fitted.parameters = data_io::ParametersJson(fit.fit.parameters).dump();
  for (const data_io::TimedPose& pose : fit.poses) fitted.poses.push_back(pose.world_from_sonar);
  return fitted;
}

py::array SegmentImage(const PolarImage& image, const Words& words) {
  metrics::Segmentation found;
  {
    const py::gil_scoped_release release;
    cli::ComparisonOptions options;
    CLI::App command;
    cli::AddComparisonOptions(command, options);
    ParseWords(command, words);
    const metrics::CompareOptions compare = options.For(image.axes);
    if (compare.object)
      throw UsageError("object: one image has no scene to search it by, expected compare()");
    found = metrics::Segment(image, compare.segmentation, compare.region ? &*compare.region : nullptr);
  }
  const auto grid = std::make_shared<Mask>(std::move(found.object));
  const py::capsule owner(new std::shared_ptr<Mask>(grid),
                          [](void* held) { delete static_cast<std::shared_ptr<Mask>*>(held); });
  return View(*grid, owner);
}

// The long names of a command's options, for a test that Python has them all.
Words OptionNames(const std::string& command_name) {
  CLI::App command;
  commands::SimulateOptions simulate;
  commands::CompareCommandOptions compare;
  commands::FitCommandOptions fit;
  if (command_name == "simulate") {
    commands::AddSimulateOptions(&command, &simulate);
  } else if (command_name == "compare") {
    commands::AddCompareOptions(&command, &compare);
  } else if (command_name == "fit") {
    commands::AddFitOptions(&command, &fit);
  } else {
    throw UsageError("command '{}', expected simulate, compare or fit", command_name);
  }
  Words names;
  for (const CLI::Option* option : command.get_options()) names.push_back(option->get_name());
  return names;
}

}  // namespace

void BindRuns(py::module_& module) {
  module.def("_simulate", &Simulate, py::arg("scene"), py::arg("sonar"), py::arg("params"), py::arg("poses"),
             py::arg("times_s"), py::arg("scene_path"), py::arg("words"), py::arg("progress"),
             py::arg("say"));
  module.def("_compare", &Compare, py::arg("real"), py::arg("simulated"), py::arg("words"),
             py::arg("progress"));
  module.def(
      "_fit",
      [](const RecordingSource& recording, const Scene& scene, const std::string& params, const Words& words,
         py::object progress, py::object say) {
        Fitted fitted = Fit(recording, scene, params, words, std::move(progress), std::move(say));
        return py::make_tuple(fitted.usable, fitted.report, fitted.parameters, fitted.poses);
      },
      py::arg("recording"), py::arg("scene"), py::arg("params"), py::arg("words"), py::arg("progress"),
      py::arg("say"));
  module.def("_segment", &SegmentImage, py::arg("image"), py::arg("words"));
  module.def(
      "_parse_parameters",
      [](const std::string& text, const std::string& name) {
        return data_io::ParametersJson(data_io::ParseParameters(text, name)).dump();
      },
      py::arg("text"), py::arg("name"));
  module.def(
      "_read_parameters",
      [](const std::filesystem::path& file) {
        return data_io::ParametersJson(data_io::ReadParameters(file)).dump();
      },
      py::arg("file"));
  module.def(
      "_write_parameters",
      [](const std::filesystem::path& file, const std::string& text) {
        data_io::WriteParameters(file, data_io::ParseParameters(text, kGiven));
      },
      py::arg("file"), py::arg("text"));
  module.def("_option_names", &OptionNames, py::arg("command"));
}

}  // namespace sonarcal::python
