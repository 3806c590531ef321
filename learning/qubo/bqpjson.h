// bqpjson 1.0.0 of Los Alamos (github.com/lanl-ansi/bqpjson): value = scale (offset + linear + quadratic), variables
// are numbers, domains "spin" and "boolean".
#pragma once
#include <string>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// The bytes of json.dumps(data, sort_keys=True) and a newline. Every variable has a linear term.
std::string to_bqpjson(const Problem& problem);

/// As strict as bqpjson's validate(), and checks the version, which its schema does not. A pair given in both orders
/// adds up. The scale is multiplied in. Solutions in the file are ignored.
Problem problem_from_bqpjson(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
