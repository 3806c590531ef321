// Dense elimination of the first columns of a symmetric front. Inside sim/local_problem.
#pragma once
#include <Eigen/Core>

namespace gonogo::sim {

/// Replaces the first `count` columns of the lower triangle of f by L, with a unit diagonal that is not stored, and the
/// rest of the lower triangle by the Schur complement; inverse[count]: 1 / D. f: [rows][step], column by column, step a
/// multiple of 4, rows behind `rows` 0. What stands above the diagonal is lost. False for a pivot that is 0 or not a
/// number.
bool eliminate(double* f, Eigen::Index rows, Eigen::Index step, Eigen::Index count, double* inverse);

}  // namespace gonogo::sim
