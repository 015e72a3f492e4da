#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "apps/commands/fitting/fit_command.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/python/json_objects.h"
#include "apps/report/detection/transfer_section.h"
#include "apps/report/sections/explain_section.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/explain.h"
#include "apps/workflow/fit.h"
#include "apps/workflow/locate.h"
#include "apps/workflow/simulate.h"
#include "apps/workflow/task/recording_transfer.h"
#include "core/types/frame_list.h"
#include "data_io/json/json_writer.h"
#include "data_io/pose_io.h"
#include "metrics/json/metrics_json.h"
#include "metrics/segmentation/segmentation.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

using Recording = std::shared_ptr<RecordingSource>;

std::vector<data_io::TimedPose> WithoutTimes(const std::vector<Pose>& poses) {
  std::vector<data_io::TimedPose> timed;
  for (const Pose& pose : poses) timed.push_back({.time_s = {}, .world_from_sonar = pose});
  return timed;
}

// Recordings and files also state times, and may state motion.
using PoseSource = std::variant<Recording, std::filesystem::path, std::vector<Pose>>;

std::vector<data_io::TimedPose> PosesOf(const PoseSource& source) {
  if (const auto* recording = std::get_if<Recording>(&source)) return data_io::PosesOfRecording(**recording);
  if (const auto* file = std::get_if<std::filesystem::path>(&source))
    return data_io::ReadPosesOrRecording(*file);
  return WithoutTimes(std::get<std::vector<Pose>>(source));
}

Recording Simulate(const Scene& scene, const workflow::SonarChoice& sonar, const ParameterSet& parameters,
                   const PoseSource& poses, const std::string& scene_path,
                   const workflow::SimulateOptions& options, py::object progress, py::object say) {
  Listener listener(std::move(progress), std::move(say));
  const py::gil_scoped_release release;
  return listener.Run([&](const workflow::Listener& task) {
    return workflow::Simulate(scene, sonar, parameters, PosesOf(poses), options, task, scene_path);
  });
}

// A comparison with its recordings, so that any pair of frames can be shown later. Images are not kept.
struct ComparedRecordings {
  Recording real;
  Recording simulated;
  workflow::Comparison comparison;

  workflow::ComparedFrame Pair(int frame) const {
    return std::move(workflow::ComparedFrames(*real, *simulated, comparison.options, {frame}).front());
  }
};

ComparedRecordings Compare(Recording real, Recording simulated, workflow::CompareOptions options,
                           const std::vector<int>& frames, const std::shared_ptr<Scene>& scene,
                           bool residuals_by_scene, py::object progress) {
  Listener listener(std::move(progress), py::none());
  const py::gil_scoped_release release;
  options.frames = frames;
  workflow::Comparison comparison = listener.Run([&](const workflow::Listener& task) {
    return workflow::Compare(*real, *simulated, options, scene.get(), residuals_by_scene, task);
  });
  return {std::move(real), std::move(simulated), std::move(comparison)};
}

py::tuple Fit(const RecordingSource& recording, const Scene& scene, const py::object& params,
              const workflow::FitOptions& options, py::object progress, py::object say) {
  Listener listener(std::move(progress), std::move(say));
  const ParameterSet start = StartFromObject(params, options.materials.Known());
  workflow::RecordingFit fit;
  std::string report;
  {
    const py::gil_scoped_release release;
    fit = listener.Run([&](const workflow::Listener& task) {
      return workflow::Fit(recording, scene, start, options, task);
    });
    report = commands::FitJson(fit);
  }
  std::vector<Pose> poses;
  for (const data_io::TimedPose& pose : fit.poses) poses.push_back(pose.world_from_sonar);
  return py::make_tuple(fit.fit.usable, ObjectFromJson(report),
                        fit.fit.usable ? DictFromParameters(fit.fit.parameters) : py::object(py::none()),
                        poses, std::move(fit.frames_before), std::move(fit.frames_after));
}

py::tuple Locate(const RecordingSource& recording, const Scene& target, const std::vector<int>& frames,
                 const workflow::LocateOptions& options, const std::vector<Pose>& start, py::object progress,
                 py::object say) {
  Listener listener(std::move(progress), std::move(say));
  workflow::Location location;
  std::string poses;
  {
    const py::gil_scoped_release release;
    location = listener.Run([&](const workflow::Listener& task) {
      return workflow::Locate(recording, target, frames, options, WithoutTimes(start), task);
    });
    poses = data_io::PosesText(location.Poses());
  }
  return py::make_tuple(ObjectFromJson(poses), Recording(std::move(location.recording)),
                        std::move(location.scene), DictFromParameters(location.parameters));
}

py::tuple Explain(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                  const workflow::ExplainOptions& options, py::object progress, py::object say) {
  Listener listener(std::move(progress), std::move(say));
  workflow::ExplainedRecording explained;
  std::string report;
  {
    const py::gil_scoped_release release;
    explained = listener.Run([&](const workflow::Listener& task) {
      return workflow::Explain(recording, scene, start, options, task);
    });
    report = data_io::JsonLine(report::ExplanationJson(explained, {.synthetic = recording.info().synthetic}));
  }
  return py::make_tuple(ObjectFromJson(report),
                        DictFromParameters(explained.explanation.steps.back().parameters),
                        std::move(explained.maps));
}

std::vector<const RecordingSource*> Pointers(const std::vector<Recording>& recordings) {
  std::vector<const RecordingSource*> pointers;
  for (const Recording& recording : recordings) pointers.push_back(recording.get());
  return pointers;
}

py::object Transfer(const std::vector<Recording>& training, const std::vector<Recording>& training_masks,
                    const std::vector<Recording>& test, const std::vector<Recording>& test_masks,
                    const workflow::TransferOptions& options, py::object progress) {
  Listener listener(std::move(progress), py::none());
  std::string figures;
  {
    const py::gil_scoped_release release;
    const workflow::RecordingTransfer result = listener.Run([&](const workflow::Listener& task) {
      return workflow::Transfer({.training = Pointers(training),
                                 .training_masks = Pointers(training_masks),
                                 .test = Pointers(test),
                                 .test_masks = Pointers(test_masks)},
                                options, task);
    });
    figures = data_io::JsonLine(report::TransferJson(result));
  }
  return ObjectFromJson(figures);
}

py::array SegmentImage(const PolarImage& image, const workflow::ComparisonOptions& options) {
  metrics::Segmentation found;
  {
    const py::gil_scoped_release release;
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

void BindComparedFrame(py::module_& module) {
  using workflow::ComparedFrame;
  py::class_<ComparedFrame>(module, "ComparedFrame", "A pair of images with the objects found in them.")
      .def_property_readonly(
          "index", [](const ComparedFrame& frame) { return frame.metrics.index; }, "Frame of the recording.")
      .def_property_readonly(
          "real", [](const ComparedFrame& frame) -> const PolarImage& { return frame.real; },
          py::return_value_policy::reference_internal, "Recorded image.")
      .def_property_readonly(
          "simulated", [](const ComparedFrame& frame) -> const PolarImage& { return frame.simulated; },
          py::return_value_policy::reference_internal, "Simulated image.")
      .def_property_readonly(
          "real_object",
          [](const py::object& self) {
            return View(self.cast<const ComparedFrame&>().metrics.masks.value().polar_real, self);
          },
          "1 where the recorded object is, shape (range_bins, beams), uint8; a read-only view.")
      .def_property_readonly(
          "simulated_object",
          [](const py::object& self) {
            return View(self.cast<const ComparedFrame&>().metrics.masks.value().polar_simulated, self);
          },
          "1 where the simulated object is, shape (range_bins, beams), uint8; a read-only view.");
}

void BindComparedRecordings(py::module_& module) {
  py::class_<ComparedRecordings>(module, "_ComparedRecordings",
                                 "A comparison with its recordings, from which it shows pairs of frames.")
      .def(
          "metrics",
          [](const ComparedRecordings& compared) {
            return ObjectFromJson(metrics::MetricsJson(compared.comparison.metrics));
          },
          "metrics.json as a dict.")
      .def(
          "telling_frames",
          [](const ComparedRecordings& compared) {
            return workflow::RepresentativeFrames(compared.comparison.metrics);
          },
          "Frames with the lowest, the middle and the highest intensity error.")
      .def("pair", &ComparedRecordings::Pair, py::arg("frame"), py::call_guard<py::gil_scoped_release>(),
           "Compares one frame again and returns its images and objects.");
}

void BindCauseMap(py::module_& module) {
  using workflow::CauseMap;
  py::class_<CauseMap>(module, "CauseMap", "Main cause of each pixel of a frame.")
      .def_readonly("index", &CauseMap::index, "Frame of the recording.")
      .def_property_readonly(
          "cause", [](const py::object& self) { return View(self.cast<const CauseMap&>().cause, self); },
          "Index into Explanation.cause_names, shape (range_bins, beams), uint8; a read-only view.")
      .def_property_readonly(
          "lobe_of", [](const py::object& self) { return View(self.cast<const CauseMap&>().lobe_of, self); },
          "Beam whose direction a side lobe shows, else -1, shape (range_bins, beams), int32; a read-only "
          "view.")
      .def_property_readonly(
          "recorded", [](const CauseMap& map) -> const PolarImage& { return map.recorded; },
          py::return_value_policy::reference_internal, "Recorded image.");
}

}  // namespace

void BindRuns(py::module_& module) {
  BindComparedFrame(module);
  BindComparedRecordings(module);
  BindCauseMap(module);
  module.def("_simulate", &Simulate, py::arg("scene"), py::arg("sonar"), py::arg("params"), py::arg("poses"),
             py::arg("scene_path"), py::arg("options"), py::arg("progress"), py::arg("say"));
  module.def("_compare", &Compare, py::arg("real"), py::arg("simulated"), py::arg("options"),
             py::arg("frames"), py::arg("scene"), py::arg("residuals_by_scene"), py::arg("progress"));
  module.def("_fit", &Fit, py::arg("recording"), py::arg("scene"), py::arg("params"), py::arg("options"),
             py::arg("progress"), py::arg("say"));
  module.def("_locate", &Locate, py::arg("recording"), py::arg("target"), py::arg("frames"),
             py::arg("options"), py::arg("start"), py::arg("progress"), py::arg("say"));
  module.def("_explain", &Explain, py::arg("recording"), py::arg("scene"), py::arg("params"),
             py::arg("options"), py::arg("progress"), py::arg("say"));
  module.def("_transfer", &Transfer, py::arg("training"), py::arg("training_masks"), py::arg("test"),
             py::arg("test_masks"), py::arg("options"), py::arg("progress"));
  module.def("_segment", &SegmentImage, py::arg("image"), py::arg("options"));
  module.def(
      "_frames",
      [](const std::string& text, int frame_count) {
        return FrameList::Read("frames", text).In(frame_count);
      },
      py::arg("text"), py::arg("frame_count"));
}

}  // namespace sonarcal::python
