#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <memory>

#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/workflow/simulate.h"
#include "data_io/open_recording.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/locked_recording.h"
#include "data_io/recordings/recalibrated_recording.h"
#include "data_io/recordings/recording_io.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

std::shared_ptr<RecordingSource> Open(const std::filesystem::path& path) {
  return std::make_shared<data_io::LockedRecording>(data_io::OpenRecording(path));
}

// Index as Python has it: from the end where negative.
int FrameIndex(const RecordingSource& recording, int index) {
  const int count = recording.frame_count();
  const int from_start = index < 0 ? index + count : index;
  if (from_start < 0 || from_start >= count)
    throw py::index_error(fmt::format("frame {} of a recording of {}", index, count));
  return from_start;
}

// Some frames of a recording in any order, numbered from 0.
class SelectedFrames final : public RecordingSource {
 public:
  SelectedFrames(std::shared_ptr<const RecordingSource> recording, std::vector<int> frames)
      : recording_(std::move(recording)), frames_(std::move(frames)) {}

  const RecordingInfo& info() const override { return recording_->info(); }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  FrameInfo frame_info(int index) const override { return recording_->frame_info(frames_.at(index)); }
  Frame ReadFrame(int index) const override { return recording_->ReadFrame(frames_.at(index)); }

 private:
  std::shared_ptr<const RecordingSource> recording_;
  std::vector<int> frames_;
};

std::shared_ptr<RecordingSource> SliceOf(std::shared_ptr<RecordingSource> recording, const py::slice& slice) {
  py::ssize_t start = 0;
  py::ssize_t stop = 0;
  py::ssize_t step = 0;
  py::ssize_t count = 0;
  if (!slice.compute(recording->frame_count(), &start, &stop, &step, &count)) throw py::error_already_set();
  std::vector<int> frames;
  for (py::ssize_t i = 0; i < count; ++i) frames.push_back(static_cast<int>(start + i * step));
  return std::make_shared<SelectedFrames>(std::move(recording), std::move(frames));
}

Frame ReadFrameOf(const RecordingSource& recording, int index) {
  const int frame = FrameIndex(recording, index);
  const py::gil_scoped_release release;
  return recording.ReadFrame(frame);
}

void CheckGrey(const Grid<float>& value, double full_scale, int frame) {
  for (int row = 0; row < value.rows(); ++row) {
    for (int col = 0; col < value.cols(); ++col) {
      const float grey = value(row, col);
      if (std::isfinite(grey) && grey >= 0.0F && static_cast<double>(grey) <= full_scale) continue;
      throw DataError("image {}: value {:g} at range bin {}, beam {}, expected 0 .. {:g}", frame, grey, row,
                      col, full_scale);
    }
  }
}

template <typename T>
void CheckLength(const std::vector<T>& list, std::size_t frames, const char* what) {
  if (list.empty() || list.size() == frames) return;
  throw DataError("{}: {} for {} images, expected one for each", what, list.size(), frames);
}

std::shared_ptr<RecordingSource> FromImages(const std::vector<FloatArray>& images, const SonarModel& sonar,
                                            const std::vector<Pose>& poses,
                                            const std::vector<double>& times_s, double full_scale,
                                            std::optional<double> db_min, std::optional<double> db_max,
                                            const py::object& valid, std::string source, bool synthetic) {
  if (images.empty()) throw DataError("images: none, expected one or more");
  CheckLength(poses, images.size(), "poses");
  CheckLength(times_s, images.size(), "times_s");
  if (!(full_scale > 0.0)) throw DataError("full_scale: {:g}, expected a positive number", full_scale);
  const PolarAxes& axes = sonar.axes;
  RecordingInfo info;
  info.source = std::move(source);
  info.format = "NumPy";
  info.sonar = sonar;
  info.scale = {.quantity = Quantity::kGrey,
                .full_scale = full_scale,
                .db_min = db_min,
                .db_max = db_max,
                .db_span = {}};
  info.synthetic = synthetic;
  if (!valid.is_none()) {
    info.valid = MaskFrom(py::array(valid), axes.range_bins, axes.beam_count(), "valid");
  }
  std::vector<Frame> frames;
  for (const FloatArray& image : images) {
    const int index = static_cast<int>(frames.size());
    Frame frame{
        .info = {.name = fmt::format("frame {}", index), .time_s = {}, .world_from_sonar = {}},
        .image = {axes, info.scale,
                  GridFrom(image, axes.range_bins, axes.beam_count(), fmt::format("image {}", index))}};
    CheckGrey(frame.image.value, full_scale, index);
    if (!poses.empty()) frame.info.world_from_sonar = poses[index];
    if (!times_s.empty()) frame.info.time_s = times_s[index];
    frames.push_back(std::move(frame));
  }
  return std::make_shared<MemoryRecording>(std::move(info), std::move(frames));
}

void BindFrame(py::module_& module) {
  py::class_<Frame>(module, "Frame", "One ping of a recording.")
      .def_property_readonly(
          "image", [](const Frame& frame) -> const PolarImage& { return frame.image; },
          py::return_value_policy::reference_internal, "Range bins x beams.")
      .def_property_readonly(
          "name", [](const Frame& frame) { return frame.info.name; }, "File name, or 'frame 3'.")
      .def_property_readonly(
          "time_s", [](const Frame& frame) { return frame.info.time_s; },
          "When it was taken, seconds; None where unknown.")
      .def_property_readonly(
          "pose", [](const Frame& frame) { return frame.info.world_from_sonar; },
          "world_from_sonar; None where unknown.");
}

void BindRecordingClass(py::module_& module) {
  using Source = RecordingSource;
  py::class_<Source, std::shared_ptr<Source>>(
      module, "Recording",
      "Frames of a sonar, read one at a time: recording[i], len(recording), for frame in recording. A slice\n"
      "such as recording[2:5] is a Recording too.")
      .def("__len__", &Source::frame_count)
      .def("__getitem__", &ReadFrameOf, py::arg("index"))
      .def("__getitem__", &SliceOf, py::arg("frames"))
      .def(
          "__iter__",
          [](const py::object& self) { return py::reinterpret_steal<py::object>(PySeqIter_New(self.ptr())); })
      .def_property_readonly(
          "source", [](const Source& r) { return r.info().source; }, "File or folder it was read from.")
      .def_property_readonly("format", [](const Source& r) { return r.info().format; })
      .def_property_readonly(
          "synthetic", [](const Source& r) { return r.info().synthetic; }, "Whether a simulation made it.")
      .def_property_readonly(
          "sonar",
          [](const Source& r) {
            return workflow::SonarChoice{r.info().sonar, r.info().water, {}};
          },
          "What it says of its sonar and water.")
      .def_property_readonly(
          "full_scale", [](const Source& r) { return r.info().scale.full_scale; },
          "The largest value a grey pixel can take.")
      .def_property_readonly(
          "db_min", [](const Source& r) { return r.info().scale.db_min; },
          "Level shown as 0, dB; None where unknown.")
      .def_property_readonly(
          "db_max", [](const Source& r) { return r.info().scale.db_max; },
          "Level shown as full_scale, dB; None where unknown.")
      .def_property_readonly(
          "valid",
          [](const py::object& self) -> py::object {
            const auto& valid = self.cast<const Source&>().info().valid;
            if (!valid) return py::none();
            return View(*valid, self);
          },
          "1 where a sample holds a measurement, shape (range_bins, beams), uint8, a read-only view; None: "
          "all do.")
      .def_property_readonly("source_level_db", [](const Source& r) { return r.info().source_level_db; })
      .def_property_readonly(
          "scene_path", [](const Source& r) { return r.info().scene_path; },
          "Scene that it was taken of; None where unknown.")
      .def_property_readonly(
          "details", [](const Source& r) { return r.info().details; },
          "What else the file says, as (name, value with unit).")
      .def_property_readonly(
          "notes", [](const Source& r) { return r.info().notes; },
          "Quirks met while reading, a sentence each.")
      .def(
          "poses",
          [](const Source& r) {
            std::vector<Pose> poses;
            for (const data_io::TimedPose& pose : data_io::PosesOfRecording(r))
              poses.push_back(pose.world_from_sonar);
            return poses;
          },
          "world_from_sonar of every frame; DataError where one has none.")
      .def(
          "with_sonar",
          [](std::shared_ptr<Source> r, const workflow::SonarChoice& sonar) -> std::shared_ptr<Source> {
            return std::make_shared<data_io::RecalibratedRecording>(std::move(r), sonar.sonar);
          },
          py::arg("sonar"),
          "This recording with another description of its sonar, such as the calibrated one; DataError if it "
          "has another number of\n"
          "range bins or beams.")
      .def(
          "times_s",
          [](const Source& r) {
            std::vector<std::optional<double>> times;
            times.reserve(static_cast<std::size_t>(r.frame_count()));
            for (int i = 0; i < r.frame_count(); ++i) times.push_back(r.frame_info(i).time_s);
            return times;
          },
          "When each frame was taken, seconds; None where unknown.")
      .def(
          "save",
          [](const Source& r, const std::filesystem::path& folder, int bits, bool force,
             py::object progress) {
            const Listener listener(std::move(progress), py::none());
            const py::gil_scoped_release release;
            cli::RunOutput output(folder, "save", force);
            data_io::WriteRecording(r, output.directory(),
                                    {.bits = bits, .progress = [&](int done, int in_all) {
                                       listener.Progress("Writing", done, in_all);
                                     }});
            cli::WriteProvenance(output.staging(),
                                 {.command = "save",
                                  .configuration = {{"source", r.info().source}, {"bits", bits}},
                                  .inputs = {}});
            output.Commit();
          },
          py::arg("folder"), py::arg("bits") = 0, py::arg("force") = false, py::arg("progress") = py::none(),
          "Writes a recording folder, whole or not at all, in place of what an earlier save wrote there. "
          "bits: 8, 16,\n"
          "32 (float), or 0 for the fewest that hold the values. force: write into a folder that holds "
          "something else,\n"
          "which is refused otherwise. progress(what, done, total) is told of each frame.")
      .def("__repr__", [](const Source& r) {
        return fmt::format("Recording({}, {} frame{}, {} beams x {} range bins{})", r.info().source,
                           r.frame_count(), r.frame_count() == 1 ? "" : "s", r.info().sonar.axes.beam_count(),
                           r.info().sonar.axes.range_bins, r.info().synthetic ? ", synthetic" : "");
      });
}

}  // namespace

void BindRecording(py::module_& module) {
  BindFrame(module);
  BindRecordingClass(module);
  module.def("open_recording", &Open, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
             "A recording of any format that sonarcal reads (data_io/README.md), frames not read yet.");
  module.def(
      "_recording_from_images",
      [](const std::vector<FloatArray>& images, const workflow::SonarChoice& sonar,
         const std::vector<Pose>& poses, const std::vector<double>& times_s, double full_scale,
         std::optional<double> db_min, std::optional<double> db_max, const py::object& valid,
         std::string source, bool synthetic) {
        return FromImages(images, sonar.sonar, poses, times_s, full_scale, db_min, db_max, valid,
                          std::move(source), synthetic);
      },
      py::arg("images"), py::arg("sonar"), py::arg("poses"), py::arg("times_s"), py::arg("full_scale"),
      py::arg("db_min"), py::arg("db_max"), py::arg("valid"), py::arg("source"), py::arg("synthetic"));
  module.def(
      "_sonar_of_axes",
      [](const PolarAxes& axes) {
        SonarModel sonar;
        sonar.name = "unknown";
        sonar.axes = axes;
        return workflow::SonarChoice{sonar, {}, {}};
      },
      py::arg("axes"));
  module.def(
      "read_poses",
      [](const std::filesystem::path& path) {
        std::vector<Pose> poses;
        for (const data_io::TimedPose& pose : data_io::ReadPosesOrRecording(path))
          poses.push_back(pose.world_from_sonar);
        return poses;
      },
      py::arg("path"), py::call_guard<py::gil_scoped_release>(),
      "Poses of a recording of any format that has them, or of a file of poses (.json).");
  module.def(
      "write_poses",
      [](const std::filesystem::path& file, const std::vector<Pose>& poses) {
        std::vector<data_io::TimedPose> timed;
        timed.reserve(poses.size());
        for (const Pose& pose : poses) timed.push_back({.time_s = {}, .world_from_sonar = pose});
        data_io::WritePoses(file, timed);
      },
      py::arg("file"), py::arg("poses"), py::call_guard<py::gil_scoped_release>(),
      "Writes a file of poses, whole or not at all.");
}

}  // namespace sonarcal::python
