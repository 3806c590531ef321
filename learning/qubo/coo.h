// Coordinate text of dimod.serialization.coo: lines "i j value", i <= j, i = j for linear terms, and a first line
// "# vartype=BINARY" or "# vartype=SPIN". Holds no offset, no labels but numbers, no variable without coefficients.
// dimod reads no exponents (it skips such a line without a word), so values are written in fixed notation: six decimals
// as dimod writes them where these are the exact value, otherwise as many digits as identify the value.
#pragma once
#include <optional>
#include <string>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

std::string to_coo(const Problem& problem);

/// Repeated lines add up, as in dimod. Lines starting with # are comments; a vartype in one of them must agree with
/// `vartype`, and one of the two must be given. Anything else on a line is refused.
Problem problem_from_coo(const std::string& text, std::optional<Vartype> vartype, const std::string& source);

}  // namespace gonogo::learning
