#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/workflow/simulate.h"
#include "core/imaging/fan_image.h"
#include "core/types/pose.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "data_io/recordings/recording_io.h"
#include "sim/scenes/environments.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

using Three = std::array<double, 3>;
using Four = std::array<double, 4>;

Eigen::Vector3d Vector(const Three& xyz) {
  return {xyz[0], xyz[1], xyz[2]};
}

Pose MakePose(const Three& position_m, const Four& wxyz) {
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) {
    throw DataError("quaternion_wxyz: length {:g}, expected 1", rotation.norm());
  }
  return {rotation.normalized(), Vector(position_m)};
}

py::array_t<double> MatrixOf(const Pose& pose) {
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = pose.position_m;
  return py::array_t<double>({4, 4}, matrix.data());
}

void BindPose(py::module_& module) {
  py::class_<Pose>(
      module, "Pose",
      "A rigid transform: world_from_sonar takes sonar coordinates (metres; X right, Y ahead, Z up) to\n"
      "world coordinates (metres, Z up).")
      .def(py::init(&MakePose), py::arg("position_m") = Three{0, 0, 0},
           py::arg("quaternion_wxyz") = Four{1, 0, 0, 0})
      .def_static(
          "from_angles",
          [](const Three& position_m, double yaw_deg, double pitch_deg, double roll_deg) {
            return Pose{
                RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(pitch_deg), RadFromDeg(roll_deg)),
                Vector(position_m)};
          },
          py::arg("position_m"), py::arg("yaw_deg") = 0.0, py::arg("pitch_deg") = 0.0,
          py::arg("roll_deg") = 0.0,
          "Turned about the sonar's own axes: yaw about Z (positive to the left), then pitch about X "
          "(positive up),\n"
          "then roll about Y (positive lowers the right side); degrees.")
      .def_static(
          "looking_at",
          [](const Three& from_m, const Three& target_m) {
            return sim::LookingAt(Vector(from_m), Vector(target_m));
          },
          py::arg("from_m"), py::arg("target_m"),
          "A sonar at from_m that looks at target_m, its right side level.")
      .def_property_readonly(
          "position_m", [](const Pose& pose) { return Copy<double>(std::span(pose.position_m.data(), 3)); },
          "Where the sonar is, shape (3,), metres.")
      .def_property_readonly(
          "quaternion_wxyz",
          [](const Pose& pose) {
            const Eigen::Quaterniond& q = pose.rotation;
            return Copy<double>(Four{q.w(), q.x(), q.y(), q.z()});
          },
          "Rotation as (w, x, y, z), shape (4,), of length 1.")
      .def_property_readonly(
          "angles_deg",
          [](const Pose& pose) {
            const Eigen::Vector3d angles = YawPitchRollFromRotation(pose.rotation);
            return Copy<double>(Three{DegFromRad(angles[0]), DegFromRad(angles[1]), DegFromRad(angles[2])});
          },
          "Yaw, pitch and roll as from_angles takes them, shape (3,), degrees.")
      .def_property_readonly("matrix", &MatrixOf, "Homogeneous matrix, shape (4, 4).")
      .def("inverse", &Pose::Inverse, "The transform the other way.")
      .def(
          "__mul__", [](const Pose& pose, const Pose& other) { return pose * other; }, py::arg("other"),
          py::is_operator())
      .def("__repr__", [](const Pose& pose) {
        const Eigen::Vector3d angles = YawPitchRollFromRotation(pose.rotation);
        return fmt::format(
            "Pose(at ({:.3f}, {:.3f}, {:.3f}) m, yaw {:.2f}, pitch {:.2f}, roll {:.2f} degrees)",
            pose.position_m.x(), pose.position_m.y(), pose.position_m.z(), DegFromRad(angles[0]),
            DegFromRad(angles[1]), DegFromRad(angles[2]));
      });
}

PolarAxes MakeAxes(double range_min_m, double range_max_m, int range_bins,
                   const DoubleArray& beam_azimuth_deg) {
  PolarAxes axes{.range_min_m = range_min_m,
                 .range_max_m = range_max_m,
                 .range_bins = range_bins,
                 .beam_azimuth_rad = VectorFrom(beam_azimuth_deg, "beam_azimuth_deg")};
  for (double& azimuth : axes.beam_azimuth_rad) azimuth = RadFromDeg(azimuth);
  axes.Validate("axes");
  return axes;
}

// Range bins are of one length: what else the edges say can't be told from a mistake.
PolarAxes AxesFromEdges(const DoubleArray& range_edges_m, const DoubleArray& beam_azimuth_deg) {
  constexpr double kEven = 1e-3;  // of a bin, as PolarAxes::Matches has it
  const std::vector<double> edges = VectorFrom(range_edges_m, "range_edges_m");
  if (edges.size() < 2) throw DataError("range_edges_m: {} values, expected 2 or more", edges.size());
  PolarAxes axes =
      MakeAxes(edges.front(), edges.back(), static_cast<int>(edges.size()) - 1, beam_azimuth_deg);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double even_m = axes.range_min_m + static_cast<double>(i) * axes.range_bin_m();
    if (std::abs(edges[i] - even_m) <= kEven * axes.range_bin_m()) continue;
    throw DataError("range_edges_m: {:g} m at index {}, expected {:g} m: range bins of one length", edges[i],
                    i, even_m);
  }
  return axes;
}

py::array_t<double> RangeEdges(const PolarAxes& axes) {
  std::vector<double> edges;
  for (int bin = 0; bin <= axes.range_bins; ++bin)
    edges.push_back(axes.range_min_m + bin * axes.range_bin_m());
  return Copy<double>(edges);
}

py::array_t<double> RangeCentres(const PolarAxes& axes) {
  std::vector<double> centres;
  centres.reserve(static_cast<std::size_t>(axes.range_bins));
  for (int bin = 0; bin < axes.range_bins; ++bin) centres.push_back(axes.range_centre_m(bin));
  return Copy<double>(centres);
}

void BindPolarAxes(py::module_& module) {
  py::class_<PolarAxes>(
      module, "PolarAxes",
      "Where the pixels of an image lie: row = range bin (row 0 nearest), column = beam (column 0\n"
      "leftmost, the most negative azimuth).")
      .def(py::init(&MakeAxes), py::arg("range_min_m"), py::arg("range_max_m"), py::arg("range_bins"),
           py::arg("beam_azimuth_deg"))
      .def_static("from_edges", &AxesFromEdges, py::arg("range_edges_m"), py::arg("beam_azimuth_deg"),
                  "From the edges of the range bins (range_bins + 1 values, evenly spaced, metres) and the "
                  "centres of\n"
                  "the beams (degrees, rising, positive to the right).")
      .def_readonly("range_min_m", &PolarAxes::range_min_m, "Near edge of the first range bin, metres.")
      .def_readonly("range_max_m", &PolarAxes::range_max_m, "Far edge of the last range bin, metres.")
      .def_readonly("range_bins", &PolarAxes::range_bins, "Rows of an image.")
      .def_property_readonly("beam_count", &PolarAxes::beam_count, "Columns of an image.")
      .def_property_readonly("range_bin_m", &PolarAxes::range_bin_m, "Length of a range bin, metres.")
      .def_property_readonly(
          "beam_azimuth_rad",
          [](const py::object& self) { return View(self.cast<const PolarAxes&>().beam_azimuth_rad, self); },
          "Centres of the beams, shape (beams,), radians, rising; a read-only view.")
      .def_property_readonly(
          "beam_edges_rad", [](const PolarAxes& axes) { return Copy<double>(axes.BeamEdgesRad()); },
          "Edges midway between beams, shape (beams + 1,), radians.")
      .def_property_readonly("range_edges_m", &RangeEdges,
                             "Edges of the range bins, shape (range_bins + 1,), metres.")
      .def_property_readonly("range_centres_m", &RangeCentres,
                             "Centres of the range bins, shape (range_bins,), metres.")
      .def(
          "matches", [](const PolarAxes& axes, const PolarAxes& other) { return axes.Matches(other); },
          py::arg("other"), "Whether both are the same to a thousandth of a bin and of a beam.")
      .def("__repr__", [](const PolarAxes& axes) {
        return fmt::format("PolarAxes({} range bins {:.3f} .. {:.3f} m, {} beams {:.2f} .. {:.2f} degrees)",
                           axes.range_bins, axes.range_min_m, axes.range_max_m, axes.beam_count(),
                           DegFromRad(axes.beam_azimuth_rad.front()),
                           DegFromRad(axes.beam_azimuth_rad.back()));
      });
}

FanImage FanOf(const PolarImage& image, double pixel_m, int height_px) {
  const FanOptions options{.pixel_m = pixel_m, .height_px = height_px};
  options.Check();
  return FanMap(image.axes, options).Apply(image);
}

// As NumPy's protocol has it: a view, unless another type or a copy is asked for.
template <typename ImageType>
py::object ArrayOf(const py::object& self, const py::object& dtype, const py::object& copy) {
  const py::array array = View(self.cast<const ImageType&>().value, self);
  const bool as_is = dtype.is_none() || array.dtype().equal(py::dtype::from_args(dtype));
  const bool must_copy = !copy.is_none() && copy.cast<bool>();
  if (as_is) return must_copy ? array.attr("copy")() : py::object(array);
  if (!copy.is_none() && !must_copy) throw py::value_error("another type needs a copy");
  return array.attr("astype")(dtype);
}

void BindImages(py::module_& module) {
  py::class_<FanImage>(
      module, "FanImage",
      "An image laid out in metres: row 0 farthest, column 0 leftmost, square pixels. For eyes.")
      .def_property_readonly(
          "value", [](const py::object& self) { return View(self.cast<const FanImage&>().value, self); },
          "Values, shape (rows, cols), float32, 0 outside the fan; a read-only view.")
      .def("__array__", &ArrayOf<FanImage>, py::arg("dtype") = py::none(), py::arg("copy") = py::none(),
           "The values, so that np.asarray(image) is image.value.")
      .def_property_readonly(
          "inside", [](const py::object& self) { return View(self.cast<const FanImage&>().inside, self); },
          "1 inside the fan, 0 outside, shape (rows, cols), uint8; a read-only view.")
      .def_property_readonly(
          "pixel_m", [](const FanImage& fan) { return fan.axes.pixel_m; }, "Side of a pixel, metres.")
      .def_property_readonly(
          "extent_m",
          [](const FanImage& fan) {
            const FanAxes& axes = fan.axes;
            return py::make_tuple(axes.x_min_m, axes.x_min_m + axes.cols * axes.pixel_m,
                                  axes.y_max_m - axes.rows * axes.pixel_m, axes.y_max_m);
          },
          "(left, right, bottom, top) in metres, as matplotlib's imshow takes it.");

  py::class_<PolarImage>(module, "Image", "A sonar image over range and azimuth with its axes and scale.")
      .def(py::init([](const FloatArray& value, const PolarAxes& axes, double full_scale,
                       std::optional<double> db_min, std::optional<double> db_max) {
             return PolarImage{axes,
                               {.quantity = Quantity::kGrey,
                                .full_scale = full_scale,
                                .db_min = db_min,
                                .db_max = db_max,
                                .db_span = {}},
                               GridFrom(value, axes.range_bins, axes.beam_count(), "value")};
           }),
           py::arg("value"), py::arg("axes"), py::arg("full_scale") = 255.0, py::arg("db_min") = py::none(),
           py::arg("db_max") = py::none())
      .def_property_readonly(
          "value", [](const py::object& self) { return View(self.cast<const PolarImage&>().value, self); },
          "Values, shape (range_bins, beams), float32; a read-only view.")
      .def("__array__", &ArrayOf<PolarImage>, py::arg("dtype") = py::none(), py::arg("copy") = py::none(),
           "The values, so that np.asarray(image) is image.value.")
      .def_property_readonly(
          "axes", [](const PolarImage& image) -> const PolarAxes& { return image.axes; },
          py::return_value_policy::reference_internal, "Where the pixels lie.")
      .def_property_readonly(
          "full_scale", [](const PolarImage& image) { return image.scale.full_scale; },
          "The largest value a grey pixel can take.")
      .def_property_readonly(
          "db_min", [](const PolarImage& image) { return image.scale.db_min; },
          "Level shown as 0, dB; None where unknown.")
      .def_property_readonly(
          "db_max", [](const PolarImage& image) { return image.scale.db_max; },
          "Level shown as full_scale, dB; None where unknown.")
      .def_property_readonly(
          "quantity", [](const PolarImage& image) { return std::string(ToString(image.scale.quantity)); },
          "What the values are: 'grey', 'decibel', 'power' or 'depth'.")
      .def("fan", &FanOf, py::arg("pixel_m") = 0.0, py::arg("height_px") = 0,
           py::call_guard<py::gil_scoped_release>(),
           "The image laid out in metres; pixels of pixel_m metres, or as many rows as height_px; 0: one a "
           "range bin,\n"
           "800 at most.");
}

py::object WaterDict(const std::optional<Water>& water) {
  if (!water) return py::none();
  py::dict dict;
  dict["temperature_c"] = water->temperature_c;
  dict["salinity_ppt"] = water->salinity_ppt;
  dict["ph"] = water->ph;
  dict["depth_m"] = water->depth_m;
  return dict;
}

void BindSonar(py::module_& module) {
  py::class_<workflow::SonarChoice>(module, "Sonar",
                                    "What is known of a sonar before anything is fitted, and of its water.")
      .def_property_readonly("name", [](const workflow::SonarChoice& choice) { return choice.sonar.name; })
      .def_property_readonly("frequency_hz",
                             [](const workflow::SonarChoice& choice) { return choice.sonar.frequency_hz; })
      .def_property_readonly(
          "axes", [](const workflow::SonarChoice& choice) -> const PolarAxes& { return choice.sonar.axes; },
          py::return_value_policy::reference_internal, "Where the pixels of its images lie.")
      .def_property_readonly(
          "azimuth_beam_width_deg",
          [](const workflow::SonarChoice& choice) { return choice.sonar.azimuth_beam_width_deg; },
          "Two-way half-power width of a beam, degrees; 0 where unknown.")
      .def_property_readonly(
          "elevation_beam_width_deg",
          [](const workflow::SonarChoice& choice) { return choice.sonar.elevation_beam_width_deg; },
          "Two-way half-power width in elevation, degrees; 0 where unknown.")
      .def_property_readonly(
          "beam_forming",
          [](const workflow::SonarChoice& choice) -> std::optional<std::string> {
            if (choice.sonar.beam_forming == BeamForming::kUnknown) return std::nullopt;
            return std::string(ToString(choice.sonar.beam_forming));
          },
          R"("array" or "lens"; None where unknown.)")
      .def_property_readonly(
          "sound_speed_m_per_s",
          [](const workflow::SonarChoice& choice) { return choice.sonar.sound_speed_m_per_s; })
      .def_property_readonly(
          "water", [](const workflow::SonarChoice& choice) { return WaterDict(choice.water); },
          "temperature_c, salinity_ppt, ph and depth_m; None where unknown.")
      .def(
          "save",
          [](const workflow::SonarChoice& choice, const std::filesystem::path& file) {
            RecordingInfo info;
            info.sonar = choice.sonar;
            info.water = choice.water;
            data_io::WriteSonarFile(file, info);
          },
          py::arg("file"), "Writes sonar.json, which --sonar of the commands and sonar() take.")
      .def("__repr__", [](const workflow::SonarChoice& choice) {
        return fmt::format("Sonar({}, {:g} kHz, {} beams x {} range bins)", choice.sonar.name,
                           choice.sonar.frequency_hz / 1000.0, choice.sonar.axes.beam_count(),
                           choice.sonar.axes.range_bins);
      });
  module.def("sonar", &workflow::ChooseSonar, py::arg("name_or_file"),
             py::call_guard<py::gil_scoped_release>(),
             "A sonar by the name of a preset, from a recording of any format, or from a JSON file with a "
             "'sonar' object.");
  module.def(
      "sonar_presets",
      [] {
        std::vector<std::string> names;
        for (const sim::SonarPreset& preset : sim::SonarPresets()) names.emplace_back(preset.name);
        return names;
      },
      "Names that sonar() knows.");
}

}  // namespace

void BindAxes(py::module_& module) {
  BindPose(module);
  BindPolarAxes(module);
  BindImages(module);
  BindSonar(module);
}

}  // namespace sonarcal::python
