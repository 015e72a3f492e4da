// What becomes of each parameter of ours in the configuration of another simulator: every one is accounted
// for, and none is dropped silently.
//
// Names are those of fit.json ("material.floor.gsab.A", "receiver.noise_db"), and sonar.* and water.* as in
// recording.json; absorption_db_per_m is what frequency and water make.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/parameters.h"
#include "core/types/sonar_model.h"
#include "core/types/words.h"

namespace sonarcal::exporting {

// What is exported: parameters, and the sonar and water they are of.
struct ExportSource {
  ParameterSet parameters;
  SonarModel sonar;
  Water water;
  double absorption_db_per_m = 0.0;  // one way
};

enum class Expression {
  kExported,      // as it is
  kApproximated,  // by something like it; `how` says by what and how far off
  kNotExpressed,  // the other simulator has nothing for it; `how` says why
  kUnused,        // has no effect with these parameters, as mirrors of the paper's model
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
  std::string target;  // where it went, in the words of the other simulator; empty for none
  std::string how;
};

class ExportAccount {
 public:
  // Lists every parameter of the source. Those that have no effect are accounted for at once.
  explicit ExportAccount(const ExportSource& source);

  // `name` is a parameter, or with a '.' or '_' at its end all those that begin with it. What is accounted
  // for already stays as it is, so that the particular comes before the general.
  void Exported(std::string_view name, const std::string& target, const std::string& how = "");
  void Approximated(std::string_view name, const std::string& target, const std::string& how);
  void NotExpressed(std::string_view name, const std::string& why);

  // All lines, in the order of the parameters. Throws std::logic_error where one is not accounted for.
  const std::vector<AccountLine>& Lines() const;

  // {"exported": n, "approximated": n, ..., "parameters": [{"name", "value", "expression", ...}]}
  nlohmann::ordered_json ToJson() const;

  // What a user should know, a sentence each: parameters of one reason together.
  std::vector<std::string> Sentences() const;

 private:
  void Account(std::string_view name, Expression expression, const std::string& target,
               const std::string& how);

  std::vector<AccountLine> lines_;
  std::vector<bool> accounted_;
};

}  // namespace sonarcal::exporting
