// Newton's systems of an interior point over contacts, with bodies of many contacts set apart. With the columns U of
// W = B B^T (body_form.h) that belong to these hubs,
//
//   W + C = A + U U^T,   (A + U U^T)^-1 = A^-1 - A^-1 U (I + U^T A^-1 U)^-1 U^T A^-1        (Woodbury)
//
// A hub fills W, since each of its contacts touches all others through it, but gives U six columns at most. So W itself
// is never needed. Inside sim/local_problem.
#pragma once
#include "sim/local_problem/newton_system.h"

namespace gonogo::sim {

/// Whether a body has so many contacts that setting it apart pays. False where bodies are not known.
bool has_hubs(const LocalProblem& problem);

/// `problem` has bodies; the cones are symmetric.
std::unique_ptr<NewtonSystem> make_system_without_hubs(const LocalProblem& problem, const ScaledProblem& of,
                                                       const std::vector<char>& fixed);

}  // namespace gonogo::sim
