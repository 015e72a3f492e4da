// Controls of `sonarcal view`: one for every parameter of sonar, water, materials and noise, with its unit
// and bounds. Parameters that a fit may change have the bounds and steps of
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
  std::string name = {};  // as in fit.json, if it is there: "material.floor.gsab.A"
  // Path of its value in requests of the page: parameters, materials, floor, gsab, A.
  std::vector<std::string> path = {};
  std::string group = {};               // "Materials"
  std::string part = {};                // subgroup: "floor"; empty: none
  std::string label = {};               // "A, specular amplitude"
  std::string unit = {};                // "1" for a pure number
  std::optional<EchoModel> model = {};  // its model; absent: every model
  double lower = 0.0;
  double upper = 0.0;
  // Ends of the slider, about the start value, within the bounds. Typed numbers may exceed them.
  double slider_lower = 0.0;
  double slider_upper = 0.0;
  bool logarithmic = false;
  bool whole = false;     // whole numbers only
  std::string zero = {};  // meaning of 0, if it is outside the bounds but accepted
  // set if the value may be absent (null); start value when it becomes present
  std::optional<double> absent = {};
  std::vector<std::string> words = {};  // possible words in place of a number
  bool fitted = false;                  // a fit may change it
  std::string fixed_because = {};       // reason why it cannot be changed; empty: it can
};

struct ViewControlInput {
  ParameterSet parameters;  // start values
  SonarModel sonar;
  Water water;
  std::vector<std::string> material_names;  // of the scene
  bool recorded = false;  // a recording is shown beside the image; its window and beams cannot be changed
};

// Returns controls for both models, in the order of the page.
std::vector<ViewControl> ViewControls(const ViewControlInput& input);

nlohmann::ordered_json ViewControlsJson(const std::vector<ViewControl>& controls);

}  // namespace sonarcal::view
