// Simulates a recording and fits it, through the installed libraries alone.
#include <iostream>

#include "apps/workflow/fit.h"
#include "apps/workflow/simulate.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/scenes/environments.h"

int main(int argc, char** argv) {
  using namespace sonarcal;
  const std::string params = argc > 1 ? argv[1] : "params.json";
  const Scene scene = sim::FindEnvironment("tank").make({});
  std::vector<data_io::TimedPose> poses;
  for (const Pose& pose : sim::FindEnvironment("tank").viewpoints())
    poses.push_back({.world_from_sonar = pose});
  const ParameterSet truth = data_io::ReadParameters(params);
  const auto sonar = workflow::ChooseSonar("p900-45");
  const auto recording = workflow::Simulate(scene, sonar, truth, poses, {.noise = true});

  workflow::FitOptions options{.free = {"material.floor.gsab.C"}};
  options.rays.rays = RayGridSize{256, 60};
  const workflow::RecordingFit fit = workflow::Fit(*recording, scene, truth, options);
  std::cout << "floor, C: " << fit.fit.parameters.Material("floor").gsab.c
            << ", IoU: " << *fit.after.aggregate.macro.polar.At("iou").value << '\n';
  return fit.fit.usable ? 0 : 1;
}
