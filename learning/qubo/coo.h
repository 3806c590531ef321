// Coordinate text of dimod.serialization.coo: lines "i j value", i <= j, i = j for linear terms, and a first line
// "# vartype=BINARY" or "# vartype=SPIN". It has no offset, only numbers as labels, and no variable without
// coefficients. dimod silently skips lines with exponents, so values are in fixed notation: dimod's six decimals when
// these are exact, otherwise as many digits as identify the value.
#pragma once
#include <optional>
#include <string>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

std::string to_coo(const Problem& problem);

/// Repeated lines add up, as in dimod. Lines that begin with # are comments. The vartype comes from a comment or from
/// `vartype`; both must agree. Throws InputError for any other text.
Problem problem_from_coo(const std::string& text, std::optional<Vartype> vartype, const std::string& source);

}  // namespace gonogo::learning
