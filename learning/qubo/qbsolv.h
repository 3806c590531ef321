// qbsolv's problem text (.qubo): "p qubo 0 maxNodes nNodes nCouplers", nNodes lines "i i w", nCouplers lines "i j w"
// with i < j, "c" comments; minimised over {0, 1}. The comments "c offset : x" and "c scale : x" and all bytes are
// those of bqpjson's bqp2qubo. Also reads qbsolv's answer text.
#pragma once
#include <string>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

/// The problem must be in {0, 1}. Every variable has a line, also with bias 0.
std::string to_qbsolv(const Problem& problem);

/// Throws InputError unless counts match, i < j < maxNodes, and each pair is given once (qbsolv takes the last). Offset
/// and scale comments count: E = scale (offset + sum).
Problem problem_from_qbsolv(const std::string& text, const std::string& source);

/// Reads qbsolv's output: a header, a string of bits for nodes 0, 1, ..., its energy. Gives one row over the problem's
/// variables; bits of other nodes are dropped. The energy has no offset, as qbsolv prints it.
SampleSet samples_from_qbsolv(const std::string& text, const Problem& problem, const std::string& source);

}  // namespace gonogo::learning
