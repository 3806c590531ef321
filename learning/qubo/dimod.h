// dimod's JSON form of problems (bqm_schema 3.0.0) and of answers (sampleset_schema 3.2.0): what
// json.dumps(bqm.to_serializable()) writes and BinaryQuadraticModel.from_serializable reads, with compact separators.
#pragma once
#include <string>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

/// One line, no newline at the end.
std::string to_dimod_json(const Problem& problem);
/// Strict: refuses another type or schema, byte arrays, lengths that differ, values that are not numbers, repeated
/// labels or pairs, and anything after the closing brace. Sorts interactions. `source` starts every message.
Problem problem_from_dimod_json(const std::string& text, const std::string& source);

/// `packed`: 32 variables in one word (dimod's default). One line, no newline at the end.
std::string to_dimod_json(const SampleSet& samples, bool packed = true);
/// Strict as above; rows must hold values of the vartype. Energies are compared with a problem by check_answer().
SampleSet samples_from_dimod_json(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
