// JSON text with the bytes of Python's json.dumps: ASCII, numbers as in repr(). Annealing tools are written in Python,
// and hashes and test files compare bytes.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo::learning {

/// Python's repr(x): the fewest digits that read back to the same bits, with an exponent below 1e-4 and from 1e16 on.
std::string python_number(double x);

enum class JsonSpaces { compact, after };  // "," and ":"; or ", " and ": ", Python's default

/// One line, keys in their order. NaN and infinities are null, as in Json::dump().
std::string python_json(const Json& json, JsonSpaces spaces);

}  // namespace gonogo::learning
