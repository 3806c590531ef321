// Text "n m" and m lines "i j w", numbered from 1. The same syntax has three meanings:
//
//   MQLib      maximise   sum_i w_ii x_i + 2 sum_(i<j) w_ij x_i x_j   x in {0, 1}   (github.com/MQLib/MQLib)
//   Biq Mac    minimise   sum_i w_ii x_i + 2 sum_(i<j) w_ij x_i x_j   x in {0, 1}   (biqmac.aau.at: Q is symmetric)
//   rudy       maximise   sum_(cut edges ij) w_ij, a maximum cut                     (G-set, BiqMac library .mc)
//
// As energies to minimise:
//   MQLib      E = -objective: linear -w_ii, coupling -2 w_ij
//   Biq Mac    linear w_ii, coupling 2 w_ij
//   rudy       J_ij = w_ij with spins for the two sides of the cut; E = W - 2 cut, W the sum of all weights
#pragma once
#include <string>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

enum class OptimisationDialect { mqlib, biq_mac, rudy };

/// Variable k has number k + 1. mqlib and biq_mac need {0, 1}; rudy needs {-1, +1} without linear biases. Coefficients
/// of 0 and the offset are left out.
std::string to_optimisation_text(const Problem& problem, OptimisationDialect dialect);

/// Labels are the numbers less one. Throws InputError unless counts match, numbers are in range, and each pair is given
/// once, in either order. Lines that begin with # are comments, except in rudy.
Problem problem_from_optimisation_text(const std::string& text, OptimisationDialect dialect, const std::string& source);

}  // namespace gonogo::learning
