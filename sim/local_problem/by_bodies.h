// Newton's systems of an interior point over bodies in place of contacts. With W = B B^T (body_form.h) and the cones'
// C,
//
//   (B B^T + C)^-1 = C^-1 - C^-1 B (I + B^T C^-1 B)^-1 B^T C^-1                      (Woodbury)
//
// The matrix to factorise has six rows per body. Packed spheres have about two contacts with three rows each per body,
// and a body with many contacts, which fills all of W, is one block here. Inside sim/local_problem.
#pragma once
#include "sim/local_problem/newton_system.h"

namespace gonogo::sim {

/// `problem` has bodies.
std::unique_ptr<NewtonSystem> make_system_by_bodies(const LocalProblem& problem, const ScaledProblem& of,
                                                    const std::vector<char>& fixed, bool is_symmetric);

}  // namespace gonogo::sim
