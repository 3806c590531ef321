// JSON text with the bytes that Python's json.dumps writes: ASCII only, numbers as repr() prints them. The annealing
// world's files are written by Python, and hashes and goldens are over bytes.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo::learning {

/// repr(x) of Python: the fewest digits that read back to the same bits, an exponent below 1e-4 and from 1e16 on.
std::string python_number(double x);

enum class JsonSpaces { compact, after };  // "," and ":"; or ", " and ": ", Python's default

/// One line. Keys keep their order. Numbers must be finite.
std::string python_json(const Json& json, JsonSpaces spaces);

}  // namespace gonogo::learning
