// The controls of `sonarcal view`: one for every parameter of sonar, water, materials and noise, with its
// unit and bounds. Those that a fit may move have the bounds and steps of
// calib/parameters/parameter_catalog.h; the others those of the table in view_controls.cc.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"

namespace sonarcal::view {

struct ViewControl {
  std::string name = {};  // as in fit.json where it is there: "material.floor.gsab.A"
  std::vector<std::string> path =
      {};                  // of its value in what the page sends: parameters, materials, floor, gsab, A
  std::string group = {};  // "Materials"
  std::string part = {};   // of the group: "floor"; empty for none
  std::string label = {};  // "A, specular amplitude"
  std::string unit = {};   // "1" for none
  std::optional<EchoModel> model = {};  // which it is a parameter of; absent: every model
  double lower = 0.0;
  double upper = 0.0;
  // Where a slider ends: about the value at the start, within the bounds. Numbers may be typed beyond.
  double slider_lower = 0.0;
  double slider_upper = 0.0;
  bool logarithmic = false;
  bool whole = false;     // whole numbers only
  std::string zero = {};  // what 0 means, where it stands outside the bounds and is accepted all the same
  std::optional<double> absent = {};    // may be absent (null); the value to start from where it no longer is
  std::vector<std::string> words = {};  // a choice of words in place of a number
  bool fitted = false;                  // of the catalogue: a fit may move it
  std::string fixed_because = {};       // where it can't be changed, why
};

struct ViewControlInput {
  ParameterSet parameters;  // values at the start
  SonarModel sonar;
  Water water;
  std::vector<std::string> material_names;  // of the scene
  bool recorded = false;  // a recording is shown beside: its window and beams stay as they are
};

// Of both models, in the order of the page.
std::vector<ViewControl> ViewControls(const ViewControlInput& input);

nlohmann::ordered_json ViewControlsJson(const std::vector<ViewControl>& controls);

}  // namespace sonarcal::view
