// Parts of the module `_sonarcal`, in the order in which they must be registered. Each is thin: the work is
// done by the libraries and by apps/workflow.
#pragma once

#include <pybind11/pybind11.h>

namespace sonarcal::python {

void BindAxes(pybind11::module_& module);         // Pose, PolarAxes, Image, FanImage, Sonar
void BindScene(pybind11::module_& module);        // Scene, read_scene, environments
void BindRecording(pybind11::module_& module);    // Frame, Recording, open_recording, poses
void BindParameters(pybind11::module_& module);   // Parameters
void BindAllOptions(pybind11::module_& module);   // FitOptions and the like
void BindRuns(pybind11::module_& module);         // simulate, compare, fit, explain, segment, transfer
void BindCalibration(pybind11::module_& module);  // calibrate, judge_noise
void BindResiduals(pybind11::module_& module);    // ResidualView
void BindReproduce(pybind11::module_& module);    // the paper's tank, and the bomb with what is known of it

}  // namespace sonarcal::python
