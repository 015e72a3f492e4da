#include <pybind11/stl.h>

#include <memory>
#include <mutex>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/hooks.h"
#include "apps/python/residual_view.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

// One evaluation at a time: others wait, without the GIL.
class LockedView {
 public:
  template <typename... Args>
  explicit LockedView(Args&&... args) : view_(std::forward<Args>(args)...) {}

  FrameResiduals At(const calib::ParameterValues& values, int frame, const std::vector<std::string>& names) {
    const std::lock_guard lock(mutex_);
    return view_.At(values, frame, names);
  }
  void WeighAbout(const calib::ParameterValues& values) {
    const std::lock_guard lock(mutex_);
    view_.WeighAbout(values);
  }
  const ResidualView& view() const { return view_; }

 private:
  ResidualView view_;
  std::mutex mutex_;
};

std::unique_ptr<LockedView> MakeView(std::shared_ptr<RecordingSource> recording, const Scene& scene,
                                     ParameterSet params, std::vector<int> frames,
                                     const workflow::RayOptions& rays, py::object progress) {
  const Listener listener(std::move(progress), py::none());
  const py::gil_scoped_release release;
  workflow::FitRecordingOptions options{.rays = rays, .config = {}, .fit = {}, .comparison = {}};
  options.on_trace = [&](int done, int in_all) { listener.Progress("Tracing", done, in_all); };
  const workflow::ThreadLimit threads(options.rays.threads);
  return std::make_unique<LockedView>(std::move(recording), scene, std::move(params), std::move(frames),
                                      options);
}

template <typename Value>
std::vector<Value> OfEntries(const LockedView& view, Value calib::CatalogEntry::*member) {
  std::vector<Value> values;
  for (const calib::CatalogEntry& entry : view.view().catalog()) values.push_back(entry.*member);
  return values;
}

}  // namespace

void BindResiduals(py::module_& module) {
  py::class_<FrameResiduals>(module, "FrameResiduals", "Residual and Jacobian of a frame at given values.")
      .def_property_readonly(
          "expected", [](const FrameResiduals& r) -> const PolarImage& { return r.expected; },
          py::return_value_policy::reference_internal,
          "What the model expects, on the recording's grey scale.")
      .def_property_readonly(
          "recorded", [](const FrameResiduals& r) -> const PolarImage& { return r.recorded; },
          py::return_value_policy::reference_internal, "What was recorded.")
      .def_property_readonly(
          "residual",
          [](const py::object& self) { return View(self.cast<const FrameResiduals&>().residual, self); },
          "Shape (range_bins, beams), float64, 0 where a pixel does not count; a read-only view.\n"
          "Paper's model: expected - recorded in full scales, or what weigh_about() makes of it.\n"
          "Acoustic model: that whose half square is the negative log-likelihood of speckle.")
      .def_property_readonly(
          "counted",
          [](const py::object& self) { return View(self.cast<const FrameResiduals&>().counted, self); },
          "1 for the pixels that a fit counts, shape (range_bins, beams), uint8; a read-only view.")
      .def_property_readonly(
          "jacobian",
          [](const py::object& self) {
            const auto& r = self.cast<const FrameResiduals&>();
            return View(r.jacobian.data(),
                        {r.residual.rows(), r.residual.cols(), static_cast<py::ssize_t>(r.names.size())},
                        self);
          },
          "d residual / d value, shape (range_bins, beams, names), float64, by the parameter's unit; a "
          "read-only view.")
      .def_property_readonly(
          "names", [](const FrameResiduals& r) { return r.names; },
          "The parameters of the Jacobian's last axis.");
  py::class_<LockedView>(module, "ResidualView",
                         "The residual of a fit at any parameters, for inspection: the models are the "
                         "library's own, nothing is solved.")
      .def_property_readonly(
          "names", [](const LockedView& v) { return OfEntries(v, &calib::CatalogEntry::name); },
          "Every parameter of the model, as in fit.json.")
      .def_property_readonly("units",
                             [](const LockedView& v) { return OfEntries(v, &calib::CatalogEntry::unit); })
      .def_property_readonly(
          "lower",
          [](const LockedView& v) { return Copy<double>(OfEntries(v, &calib::CatalogEntry::lower)); },
          "Lower bounds, shape (names,).")
      .def_property_readonly(
          "upper",
          [](const LockedView& v) { return Copy<double>(OfEntries(v, &calib::CatalogEntry::upper)); },
          "Upper bounds, shape (names,).")
      .def_property_readonly(
          "initial", [](const LockedView& v) { return Copy<double>(v.view().initial_values()); },
          "The values of the parameters given, shape (names,).")
      .def_property_readonly(
          "frames", [](const LockedView& v) { return v.view().frames(); },
          "Frames of the recording that it looks at.")
      .def(
          "at",
          [](LockedView& view, const DoubleArray& values, int frame, const std::vector<std::string>& names) {
            const std::vector<double> at = VectorFrom(values, "values");
            const py::gil_scoped_release release;
            return view.At(at, frame, names);
          },
          py::arg("values"), py::arg("frame"), py::arg("names") = std::vector<std::string>{},
          "Residual of a frame at values (shape (names,), in the parameters' units), and its Jacobian by "
          "the\n"
          "parameters named. Moving or naming those of beam, pulse or pose traces the frames again.")
      .def(
          "weigh_about",
          [](LockedView& view, const DoubleArray& values) {
            const std::vector<double> about = VectorFrom(values, "values");
            const py::gil_scoped_release release;
            view.WeighAbout(about);
          },
          py::arg("values"),
          "Weighs residuals of the paper's model from now on by the noise that the frames show about values\n"
          "(shape (names,)): half their squared sum is then the cost of a fit that ended at these values.");
  module.def("_residual_view", &MakeView, py::arg("recording"), py::arg("scene"), py::arg("params"),
             py::arg("frames"), py::arg("options"), py::arg("progress"));
}

}  // namespace sonarcal::python
