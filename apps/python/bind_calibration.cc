#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/commands/fitting/fit_command.h"
#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/python/json_objects.h"
#include "apps/report/detection/false_alarm_section.h"
#include "apps/report/sections/noise_section.h"
#include "apps/workflow/calibration/calibrate.h"
#include "apps/workflow/noise/judge_noise.h"
#include "apps/workflow/simulate.h"
#include "core/sonars/sonar_geometry.h"
#include "data_io/json/json_writer.h"
#include "data_io/pose_io.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

// None, a dict in the form of plan.json, or the path of such a file.
workflow::CalibrationPlan PlanFrom(const py::object& plan) {
  if (plan.is_none()) return {};
  if (IsPath(plan)) return workflow::ReadCalibrationPlan(py::str(plan).cast<std::string>());
  if (!IsMapping(plan)) throw py::type_error("plan: expected a dict, a path or None");
  return workflow::ParseCalibrationPlan(JsonFromObject(plan), "plan");
}

// Arguments of FitResult. `poses`: those of a fit that moved none.
py::tuple FitTuple(workflow::RecordingFit& fit, const std::vector<data_io::TimedPose>& poses) {
  std::vector<Pose> found;
  for (const data_io::TimedPose& pose : fit.poses.empty() ? poses : fit.poses)
    found.push_back(pose.world_from_sonar);
  return py::make_tuple(fit.fit.usable, ObjectFromJson(commands::FitJson(fit)),
                        fit.fit.usable ? DictFromParameters(fit.fit.parameters) : py::object(py::none()),
                        found, std::move(fit.frames_before), std::move(fit.frames_after));
}

py::tuple Calibrate(const RecordingSource& recording, const Scene& scene,
                    const workflow::CalibrateOptions& options, const RecordingSource* background,
                    const py::object& plan, py::object progress, py::object say) {
  Listener listener(std::move(progress), std::move(say));
  const workflow::CalibrationInput input{.background = background, .plan = PlanFrom(plan)};
  workflow::Calibration calibration;
  std::vector<data_io::TimedPose> poses;
  {
    const py::gil_scoped_release release;
    calibration = listener.Run([&](const workflow::Listener& task) {
      return workflow::Calibrate(recording, scene, options, input, task);
    });
    poses = data_io::PosesOfRecording(recording);
  }
  workflow::SonarChoice sonar{recording.info().sonar, recording.info().water, {}};
  sonar.sonar.axes = Corrected(sonar.sonar.axes, calibration.fit.geometry);
  py::object moved = py::none();
  if (calibration.fit.scene) moved = py::cast(std::move(*calibration.fit.scene));
  const std::string decisions = data_io::JsonLine(workflow::CalibrationPlanJson(calibration.plan));
  return py::make_tuple(FitTuple(calibration.fit, poses), FitTuple(calibration.evaluation, poses),
                        ObjectFromJson(decisions), std::move(sonar), std::move(moved),
                        std::move(calibration.open));
}

py::object JudgeNoise(const RecordingSource& recording, const ParameterSet& parameters,
                      const std::vector<int>& frames, const workflow::JudgeNoiseOptions& options,
                      const std::string& params_file, py::object progress, py::object say) {
  Listener listener(std::move(progress), std::move(say));
  std::string judgement;
  {
    const py::gil_scoped_release release;
    const workflow::FittedNoiseWindow fitted =
        params_file.empty() ? workflow::FittedNoiseWindow() : workflow::ReadFittedWindow(params_file);
    const workflow::JudgedNoise judged = listener.Run([&](const workflow::Listener& task) {
      return workflow::JudgeNoise(recording, parameters, frames, options, fitted, task);
    });
    nlohmann::ordered_json json = report::NoiseJudgementFileJson(judged.judgement);
    if (options.false_alarms) json["false_alarms"] = report::FalseAlarmsJson(judged.false_alarms);
    judgement = data_io::JsonLine(json);
  }
  return ObjectFromJson(judgement);
}

}  // namespace

void BindCalibration(py::module_& module) {
  module.def("_calibrate", &Calibrate, py::arg("recording"), py::arg("scene"), py::arg("options"),
             py::arg("background"), py::arg("plan"), py::arg("progress"), py::arg("say"));
  module.def("_judge_noise", &JudgeNoise, py::arg("recording"), py::arg("params"), py::arg("frames"),
             py::arg("options"), py::arg("params_file"), py::arg("progress"), py::arg("say"));
}

}  // namespace sonarcal::python
