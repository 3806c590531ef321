// The cone program of one step written out densely in double from the engine's contacts, and an independent solver for
// it: an oracle for sim/solver.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::test {

/// Five rows per contact (normal, two tangents, two rolling axes), then one per motor.
struct DenseProblem {
  Eigen::MatrixXd direction;              // D: 6 bodies x rows; linear then angular part of each body
  Eigen::MatrixXd inverse_mass;           // M^-1
  Eigen::VectorXd free_velocity;          // v + h g
  Eigen::VectorXd bias;                   // b: gap speed of each normal, minus the speed of each motor
  Eigen::VectorXd step;                   // S: the engine's step sizes
  std::vector<double> mu, rho, cohesion;  // [contact]
  std::vector<double> motor_limit;        // [motor] N m s

  Eigen::MatrixXd hessian() const { return direction.transpose() * inverse_mass * direction; }
};

/// `before`: the bodies at the start of the step, all without spin where their inertia is not isotropic, so that no
/// gyroscopic torque acts; no springs.
DenseProblem dense_problem(const sim::SceneWorld& world, const std::vector<sim::BodyState>& before,
                           const std::vector<sim::Contact>& contacts, double step);

struct DenseSolution {
  Eigen::VectorXd impulse, velocity;
  double residual = 0;  // natural map, scaled to a unit diagonal of N [square root of J]
  int iterations = 0;
};

/// ADMM with adapted penalty (Boyd et al. 2011, sections 3.3 and 3.4.1) to a natural-map residual below `tolerance`.
DenseSolution solve(const DenseProblem& problem, double tolerance, int max_iterations);

}  // namespace gonogo::test
