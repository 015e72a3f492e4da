// What a Jacobian says about parameters: their covariance, and what the data leave open.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace sonarcal::calib {

// Sums over the residuals of a least-squares problem at its solution, and over each block of residuals that
// share noise (speckle grain, range and azimuth errors) and may therefore not be counted as independent.
struct NormalEquations {
  struct Block {
    Eigen::MatrixXd information;  // J_b^T J_b
    Eigen::VectorXd score;        // J_b^T r_b
  };
  Eigen::MatrixXd information;  // J^T J
  Eigen::VectorXd prior;        // 1 / variance of what is known beforehand; empty: nothing
  std::vector<Block> blocks;    // those in which something depends on a parameter
  double residual_square = 0.0;
  long residual_count = 0;
};

// The sums of the problem in which one parameter is held.
NormalEquations HoldParameter(const NormalEquations& equations, int parameter);

struct OpenDirection {
  int parameter = 0;        // the one that takes part most
  std::string description;  // in words
};

// The direction the data determine least, where along it the parameter that moves most has a standard
// deviation of more than one typical step; nothing where all are determined. `typical_step` scales each
// parameter.
std::optional<OpenDirection> LeastDetermined(const NormalEquations& equations,
                                             const Eigen::VectorXd& typical_step,
                                             const std::vector<std::string>& names);

// Covariance by leaving out one block at a time: with the change that block b makes to the solution,
// d_b = (J^T J - J_b^T J_b)^-1 J_b^T r_b, it is (B - 1) / B sum d_b d_b^T. This is the cluster-robust
// sandwich with its small-sample correction CR3 (Cameron & Miller, J. Human Resources 50(2), 2015, section
// VI.B): a parameter that hangs on few blocks gets the wide sigma it deserves. Not finite where one block
// alone determines a parameter. A prior P adds its information to J^T J, and (J^T J + P)^-1 P (J^T J + P)^-1
// to the covariance: of what the data leave open, the prior's own variance remains.
Eigen::MatrixXd JackknifeCovariance(const NormalEquations& equations);

// Factor by which a 95 % interval is wider than 1.96 standard errors if the covariance above is a sum over
// few blocks: Student's law with as many degrees of freedom as the blocks that determine the parameter count
// for (Satterthwaite; Bell & McCaffrey, Survey Methodology 28(2), 2002). 1 for many blocks; not finite below
// two degrees of freedom.
Eigen::VectorXd StudentFactors(const NormalEquations& equations);

// A coordinate as words need it.
struct NamedCoordinate {
  std::string name;
  double step = 1.0;         // its prior's sigma, or a change that would be a surprise
  bool logarithmic = false;  // the logarithm of anything
};

// The directions in which more than kOpenShare of a prior's variance is left, the worst first, in words:
// which parameters move together, and what of them is known all the same.
std::vector<std::string> OpenDirections(const Eigen::MatrixXd& covariance,
                                        const std::vector<NamedCoordinate>& coordinates);

// Share of a prior's variance above which a parameter or a direction is called open. Below it the prior
// hardly pulls: where its centre is off by 2 sigma, a 68 % interval still covers 61 % (at a share of a half,
// 28 %).
inline constexpr double kOpenShare = 0.1;

Eigen::MatrixXd CorrelationFromCovariance(const Eigen::MatrixXd& covariance);

}  // namespace sonarcal::calib
