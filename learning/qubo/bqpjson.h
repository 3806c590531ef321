// bqpjson 1.0.0 of Los Alamos (github.com/lanl-ansi/bqpjson): value = scale (offset + linear + quadratic), variables
// are numbered, domains "spin" and "boolean".
#pragma once
#include <string>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// As json.dumps(data, sort_keys=True) writes it, one line with its end; every variable has a linear term.
std::string to_bqpjson(const Problem& problem);

/// Strict as bqpjson's own validate(), and the version is checked too (its schema forgets to). A pair given in both
/// orders adds up. The scale is multiplied in. Solutions in the file are ignored.
Problem problem_from_bqpjson(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
