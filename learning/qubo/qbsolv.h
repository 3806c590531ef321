// qbsolv's problem text (.qubo): "p qubo 0 maxNodes nNodes nCouplers", nNodes lines "i i w", nCouplers lines "i j w"
// with i < j, "c" comments; minimised over {0, 1}. The comments "c offset : x" and "c scale : x" follow bqpjson's
// bqp2qubo, whose bytes the writer reproduces. Also qbsolv's answer text.
#pragma once
#include <string>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

/// The problem must be in {0, 1}; every variable gets a line, also where its bias is 0.
std::string to_qbsolv(const Problem& problem);

/// Strict: counts must match, i < j < maxNodes, each pair once (qbsolv lets the last one win). Offset and scale
/// comments are honoured: E = scale (offset + sum).
Problem problem_from_qbsolv(const std::string& text, const std::string& source);

/// What qbsolv prints: a header, a string of bits for nodes 0, 1, ..., its energy. One row, labelled by the problem's
/// variables; bits of nodes that the problem lacks are dropped. The energy is taken without offset, as qbsolv prints
/// it.
SampleSet samples_from_qbsolv(const std::string& text, const Problem& problem, const std::string& source);

}  // namespace gonogo::learning
