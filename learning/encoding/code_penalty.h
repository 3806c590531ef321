// Penalty energy for units that are no code word: 0 for every code word, at least `strength` for all other words.
//
//   thermometer  strength sum_k u_(k+1) (1 - u_k)   for every unit that is on after one that is off
//   one_hot      strength (1 - sum_k u_k)^2         also for the outcome's units
//   gray         none: every word is a code word
//
// Energies of code words do not change, so neither do their relative probabilities. The weight of any other row falls
// by a factor of at least exp(strength). Source: Lucas, Front. Phys. 2:5 (2014), section 3 (one-hot); Chancellor,
// Quantum Sci. Technol. 4:045004 (2019), equation 3 (thermometer, there "domain wall").
#pragma once
#include <span>

#include "learning/encoding/layout.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// Adds the penalties to `qubo` (BINARY), whose first variables are the units of `layout`, for every variable, and for
/// the outcome, whose units are all free. fixed: [variable_count()], NaN for free units, as in clamp(). `strength` is
/// in the energy unit of the problem; throws InputError unless it is finite and not negative.
Problem with_code_penalty(const Problem& qubo, const VisibleLayout& layout, std::span<const double> fixed,
                          double strength);

}  // namespace gonogo::learning
