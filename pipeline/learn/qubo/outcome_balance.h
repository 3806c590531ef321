// A machine with the same rows of code words whose outcome is a code word more often.
//
// Of the outcome's units u_y exactly one is on in a code word. So (c + w.h) (1 - sum_y u_y) can be added to the energy:
// code words keep theirs to the rounding, and no two visible units get coupled, as a penalty would. c and w are chosen
// so that, given the hidden units of the machine's own code words, one outcome unit is on in the mean. That is the
// least mean of log(all words / code words), which is convex in c and w. Training on code words leaves both free.
#pragma once
#include "learning/model/model.h"
#include "learning/qubo/problem.h"

namespace gonogo::learn {

/// The whole machine as a QUBO (to_qubo() of learning/model/weights.h), balanced for rows of which nothing is known. It
/// serves clamped questions better than a balance of their own: its hidden units are more varied. Deterministic.
learning::Problem balanced_machine(const learning::Model& model);

}  // namespace gonogo::learn
