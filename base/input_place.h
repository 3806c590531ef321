// An InputError with the place of the fault in separate fields, for programs that read `gonogo --json`.
#pragma once
#include <cstddef>
#include <string>

#include "base/error.h"

namespace gonogo {

/// Place of a fault in the input. Unknown fields are empty or 0.
struct InputPlace {
  std::string file{};      // as the user named it
  std::string path{};      // of a value in a JSON file, "bed.size_m[2]"
  std::size_t line = 0;    // from 1
  std::size_t column = 0;  // from 1, in characters of UTF-8
};

/// The message names the place too.
struct PlacedInputError : InputError {
  PlacedInputError(const std::string& message, InputPlace where) : InputError(message), place(std::move(where)) {}
  InputPlace place;
};

}  // namespace gonogo
