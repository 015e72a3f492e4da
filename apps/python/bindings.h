// The parts of the module `_sonarcal`, in the order in which they must be registered. Each is thin: what it
// does is done by the rooms and by the commands of apps/.
#pragma once

#include <pybind11/pybind11.h>

namespace sonarcal::python {

void BindAxes(pybind11::module_& module);       // Pose, PolarAxes, Image, FanImage, Sonar
void BindScene(pybind11::module_& module);      // Scene, read_scene, environments
void BindRecording(pybind11::module_& module);  // Frame, Recording, open_recording, poses
void BindRuns(pybind11::module_& module);       // simulate, compare, fit, segment, parameters
void BindResiduals(pybind11::module_& module);  // ResidualView
void BindReproduce(pybind11::module_& module);  // the paper's tank, and the bomb with what is known of it

}  // namespace sonarcal::python
