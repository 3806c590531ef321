// dimod's JSON of problems (bqm_schema 3.0.0) and answers (sampleset_schema 3.2.0), as
// json.dumps(bqm.to_serializable()) writes it with compact separators and BinaryQuadraticModel.from_serializable reads
// it.
#pragma once
#include <string>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

Json dimod_json(const Problem& problem);
/// One line without newline.
std::string to_dimod_json(const Problem& problem);
/// Throws InputError for another type or schema, byte arrays, lengths that differ, values that are not numbers,
/// repeated labels or pairs, and text after the closing brace. Sorts interactions. Messages begin with `source`.
Problem problem_from_dimod_json(const std::string& text, const std::string& source);
Problem dimod_problem(const Json& json, const std::string& source);

/// `packed`: 32 variables per word, dimod's default. One line without newline.
std::string to_dimod_json(const SampleSet& samples, bool packed = true);
/// As strict as above. Values must be of the vartype. check_answer() compares the energies with a problem.
SampleSet samples_from_dimod_json(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
