// How a command ends: options that all commands share, its result, and its error as an object for programs.
#pragma once
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "base/input_place.h"
#include "base/json/json.h"

namespace gonogo::app {

/// Filled while the command line is parsed, read by commands.
struct Globals {
  bool json = false;                      // machine-readable result as the last line of stdout
  int threads = 0;                        // 0: all cores
  std::vector<std::string> command_line;  // words as given, the program first
};

/// Prints the result of a command: one JSON line under --json, otherwise `text` for people. Throws DeviceError when
/// standard output cannot be written.
void print_result(const Globals& globals, const Json& result, const std::string& text);

/// Prints a part of the text before the result is there. Nothing under --json. Throws as print_result does.
void print_row(const Globals& globals, const std::string& text);

/// Whether print_result has been called: an error that follows is told on stderr and by the exit code alone.
bool result_printed();

/// {"kind": "bad_input", "message": ..., "file": ..., "path": ..., "line": ..., "column": ...}; what is not known is
/// left out. Kinds: bad_input, failure, interrupted, one for each exit code but 0.
Json error_json(ExitCode code, const std::string& message, const InputPlace& place = {});

/// Prints a result that is complete but bad, with the member "error", and throws `error`.
template <class Error>
[[noreturn]] void fail_with_result(const Globals& globals, Json result, const std::string& text, const Error& error) {
  const bool bad_input = std::is_base_of_v<InputError, Error>;
  result["error"] = error_json(bad_input ? ExitCode::bad_input : ExitCode::failure, error.what());
  print_result(globals, result, text);
  throw error;
}

}  // namespace gonogo::app
