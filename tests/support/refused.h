// Bad input must be refused by a message that names what is wrong.
#pragma once
#include <functional>
#include <string>

#include "base/error.h"
#include "tests/support/catch.h"

namespace gonogo {

/// Checks that `act` throws InputError and that its message contains `word`.
inline void refused(const std::function<void()>& act, const std::string& word) {
  try {
    act();
    FAIL("accepted; expected a message with: " << word);
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find(word) != std::string::npos);
  }
}

}  // namespace gonogo
