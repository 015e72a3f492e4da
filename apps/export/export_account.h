// Account of an export to another simulator: states for each parameter how the configuration expresses it. No
// parameter is dropped silently.
//
// Names are those of fit.json ("material.floor.gsab.A", "receiver.noise_db"), and sonar.* and water.* as in
// recording.json. absorption_db_per_m follows from frequency and water.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "core/types/scene.h"
#include "core/types/sonar_model.h"
#include "core/types/words.h"

namespace sonarcal::exporting {

// Input of an export: parameters with their sonar and water.
struct ExportSource {
  ParameterSet parameters;
  SonarModel sonar;
  Water water;
  double absorption_db_per_m = 0.0;  // one way
  // For simulators that also get a world; absent: none, and a sonar at the origin that looks along Y.
  std::optional<Scene> scene = std::nullopt;
  std::optional<Pose> world_from_sonar = std::nullopt;
};

enum class Expression {
  kExported,      // exactly
  kApproximated,  // approximately; `how` states the substitute and its error
  kNotExpressed,  // the other simulator has no equivalent; `how` states why
  kUnused,        // has no effect with these parameters, such as mirrors in the paper's model
};
constexpr auto WordsOf(std::type_identity<Expression>) {
  return Words<Expression, 4>{{{"exported", Expression::kExported},
                               {"approximated", Expression::kApproximated},
                               {"not_expressed", Expression::kNotExpressed},
                               {"unused", Expression::kUnused}}};
}

struct AccountLine {
  std::string parameter;
  nlohmann::ordered_json value;
  Expression expression = Expression::kNotExpressed;
  std::string target;  // name in the other simulator; empty: none
  std::string how;
};

class ExportAccount {
 public:
  // Lists every parameter of the source. Accounts at once for those without effect.
  explicit ExportAccount(const ExportSource& source);

  // Account for parameter `name`, or, if it ends with '.' or '_', for all that begin with it. Parameters that
  // are already accounted for do not change, so call these for single parameters before groups.
  void Exported(std::string_view name, const std::string& target, const std::string& how = "");
  void Approximated(std::string_view name, const std::string& target, const std::string& how);
  void NotExpressed(std::string_view name, const std::string& why);

  // Returns all lines in the order of the parameters. Throws std::logic_error if one is not accounted for.
  const std::vector<AccountLine>& Lines() const;

  // Returns {"exported": n, "approximated": n, ..., "parameters": [{"name", "value", "expression", ...}]}
  nlohmann::ordered_json ToJson() const;

  // Returns messages for the user, one sentence per reason.
  std::vector<std::string> Sentences() const;

 private:
  void Account(std::string_view name, Expression expression, const std::string& target,
               const std::string& how);

  std::vector<AccountLine> lines_;
  std::vector<bool> accounted_;
};

}  // namespace sonarcal::exporting
