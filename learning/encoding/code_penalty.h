// Energy that keeps a variable's units to its code words: 0 for every code word, at least `strength` for all else.
//
//   thermometer  strength sum_k u_(k+1) (1 - u_k)   once for every unit that is on after one that is off
//   one_hot      strength (1 - sum_k u_k)^2         also the outcome's units
//   gray         none: every word is a code word
//
// Rows of code words keep their energies, and so their probabilities among each other; any other row becomes rarer by
// exp(-strength) at least. Source: Lucas, Front. Phys. 2:5 (2014), section 3 (one-hot); Chancellor, Quantum Sci.
// Technol. 4:045004 (2019), equation 3 (thermometer, there "domain wall").
#pragma once
#include <span>

#include "learning/encoding/layout.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// `qubo` (BINARY), whose first variables are the units of `layout`, with the penalty of every variable and of the
/// outcome whose units are all free. fixed: [variable_count()], not-a-number for free units, as clamp() takes it.
/// strength: energy, in the units of the problem; throws InputError unless it is finite and not negative.
Problem with_code_penalty(const Problem& qubo, const VisibleLayout& layout, std::span<const double> fixed,
                          double strength);

}  // namespace gonogo::learning
