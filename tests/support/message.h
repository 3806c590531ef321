// The sentence of the InputError that a piece of code throws.
#pragma once
#include <string>

#include "base/error.h"

namespace gonogo {

/// Empty when nothing is thrown; other exceptions pass through and fail the test.
template <class Code>
std::string input_error(Code&& code) {
  try {
    code();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace gonogo
