#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/python/json_objects.h"
#include "apps/reproduce/reproduce_report.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

struct TankResult {
  std::string metrics;
  std::shared_ptr<RecordingSource> recording;
  Scene scene;
  ParameterSet paper;  // fitted
  ParameterSet acoustic;
};

TankResult ReproduceTank(bool quick, std::uint64_t seed, int threads, py::object progress, py::object say) {
  const Listener listener(std::move(progress), std::move(say));
  const py::gil_scoped_release release;
  const workflow::ThreadLimit limit(threads);
  reproduce::SyntheticOptions options{.seed = seed, .threads = threads, .quick = quick};
  options.on_frame = [&](int done, int in_all) { listener.Progress("Recording", done, in_all); };
  options.on_note = [&](const std::string& line) { listener.Say(line); };
  reproduce::Reproduction reproduction{
      .synthetic = reproduce::CompareSynthetic(reproduce::FindCase("tank"), options),
      .targets = {},
      .shown = {}};
  reproduce::SyntheticComparison& tank = reproduction.synthetic;
  TankResult result{.metrics = reproduce::ReproductionMetricsJson(reproduction),
                    .recording = {},
                    .scene = std::move(tank.scene),
                    .paper = tank.fit.fit.parameters,
                    .acoustic = tank.acoustic.fit.parameters};
  result.recording = std::move(tank.recording);
  return result;
}

}  // namespace

void BindReproduce(py::module_& module) {
  module.def(
      "_reproduce_tank",
      [](bool quick, std::uint64_t seed, int threads, py::object progress, py::object say) {
        TankResult result = ReproduceTank(quick, seed, threads, std::move(progress), std::move(say));
        return py::make_tuple(ObjectFromJson(result.metrics), result.recording, std::move(result.scene),
                              DictFromParameters(result.paper), DictFromParameters(result.acoustic));
      },
      py::arg("quick"), py::arg("seed"), py::arg("threads"), py::arg("progress"), py::arg("say"));
  module.def(
      "_known_bomb",
      [](const std::filesystem::path& folder) {
        reproduce::PosedTarget bomb = reproduce::PoseTarget(reproduce::FindCase("bomb"), folder);
        return py::make_tuple(std::shared_ptr<RecordingSource>(std::move(bomb.recording)),
                              std::move(bomb.scene), DictFromParameters(bomb.start));
      },
      py::arg("folder"));
}

}  // namespace sonarcal::python
