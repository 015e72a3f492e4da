// Covariance of fitted parameters from the Jacobian, and the directions that the data do not determine.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/parameters/parameter_catalog.h"

namespace sonarcal::calib {

// Sums over the residuals of a least-squares problem at its solution. Also over each block of residuals that
// share noise (speckle cells, range and azimuth errors) and are therefore not independent.
struct NormalEquations {
  struct Block {
    std::vector<int> columns;     // parameters that its residuals depend on, ascending
    Eigen::MatrixXd information;  // J_b^T J_b of these columns
    Eigen::VectorXd score;        // J_b^T r_b
  };
  Eigen::MatrixXd information;  // J^T J
  Eigen::VectorXd prior;        // 1 / variance of the prior; empty: no priors
  std::vector<Block> blocks;    // blocks in which a residual depends on a parameter
  // Factor of the variance for what blocks share with their neighbours (BlockPixels).
  double variance_factor = 1.0;
  // Independent numerical errors of the summed score, as vectors: the sum of their outer products is its
  // covariance. Empty: the model is exact.
  std::vector<Eigen::VectorXd> numerical;
  double residual_square = 0.0;
  long residual_count = 0;
};

// Adds the sums of another block, which may depend on other parameters.
void AddBlock(const NormalEquations::Block& added, NormalEquations::Block& block);

// Returns the sums of the problem with one parameter fixed.
NormalEquations HoldParameter(const NormalEquations& equations, int parameter);

struct OpenDirection {
  int parameter = 0;        // the one with the largest component
  std::string description;  // in words
};

// Returns the direction that the data determine least, if the parameter with its largest component has a
// standard deviation of more than one typical step. Nullopt if all are determined. `typical_step` scales each
// parameter.
std::optional<OpenDirection> LeastDetermined(const NormalEquations& equations,
                                             const Eigen::VectorXd& typical_step,
                                             const std::vector<std::string>& names);

// Covariance by leaving out one block at a time: with the change that block b makes to the solution, d_b =
// (J^T J - J_b^T J_b)^-1 J_b^T r_b, it is (B - 1) / B sum d_b d_b^T, times the variance factor.
// This is the cluster-robust sandwich with its small-sample correction CR3 (Cameron & Miller, J. Human
// Resources 50(2), 2015, section VI.B). A parameter that few blocks determine gets a correctly large sigma.
// Not finite if one block alone determines a parameter. A prior P adds its information to J^T J, and
// (J^T J + P)^-1 P (J^T J + P)^-1 to the covariance. So directions that the data do not determine keep the
// variance of the prior. A numerical error s of the score adds the outer product of the change that it makes,
// (J^T J + P)^-1 s.
Eigen::MatrixXd JackknifeCovariance(const NormalEquations& equations);

// Factor by which a 95 % interval is wider than 1.96 standard errors if the standard error itself has few
// degrees of freedom. Uses Student's law. 1 for many; not finite below two.
double StudentFactor(double degrees_of_freedom);

// StudentFactor of each parameter for the covariance above, which is a sum over blocks. Degrees of freedom
// are those of the blocks that determine the parameter (Satterthwaite; Bell & McCaffrey, Survey Methodology
// 28(2), 2002).
Eigen::VectorXd StudentFactors(const NormalEquations& equations);

// Returns the covariance for standard errors multiplied by these factors. A factor that is not finite counts
// as 1: the data do not determine its parameter, and those of the others must not be lost.
Eigen::MatrixXd WidenedCovariance(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& factors);

// A coordinate with what its description needs.
struct NamedCoordinate {
  std::string name;
  double step = 1.0;         // sigma of its prior, or a surprisingly large change
  bool logarithmic = false;  // true: the coordinate is the logarithm of a value
};

// Describes the directions that keep more than kOpenShare of the prior variance, the worst first: which
// parameters move together, and which combination of them is determined.
std::vector<std::string> OpenDirections(const Eigen::MatrixXd& covariance,
                                        const std::vector<NamedCoordinate>& coordinates);

Eigen::MatrixXd CorrelationFromCovariance(const Eigen::MatrixXd& covariance);

}  // namespace sonarcal::calib
