// What every command needs: the options of the program, how a command ends, names of values, examples, the registry.
// Callbacks of commands throw InputError, DeviceError or Cancelled; main() turns them into one sentence and an exit
// code.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
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

// Names of values in help, the man page and completions, by which they are completed (complete.h).
inline constexpr const char* kFile = "FILE";
inline constexpr const char* kFolder = "FOLDER";
inline constexpr const char* kModel = "MODEL";              // file, or name of one in data
inline constexpr const char* kStudy = "STUDY";              // file
inline constexpr const char* kVehicle = "VEHICLE";          // file, or name of one in configs/vehicles
inline constexpr const char* kSoil = "SOIL";                // file, or name of one in configs/soils
inline constexpr const char* kTable = "TABLE";              // calibration: file, or name of one in configs/soils
inline constexpr const char* kBenchmark = "BENCHMARK";      // file, or name of one in configs/benchmarks
inline constexpr const char* kVariable = "VARIABLE";        // of the contract, or a measure
inline constexpr const char* kSetting = "VARIABLE=NUMBER";  // of the contract
inline constexpr const char* kCommand = "COMMAND";          // of this program

/// Seeds are unsigned, and CLI11 takes -1 for the greatest.
inline const CLI::Validator kSeed(
    [](std::string& text) -> std::string {
      return !text.empty() && text.front() == '-' ? text + " is given; 0 or a positive whole number is possible" : "";
    },
    "");

/// An option whose value has the name `kind` in the help, by which it is completed.
template <class Type>
CLI::Option* add_named(CLI::App& command, const std::string& name, Type& value, const std::string& kind,
                       const std::string& about) {
  return command.add_option(name, value, about)->type_name(kind);
}

/// Whether models of a vehicle start from what its family's model says, and which model that is.
struct FamilyChoice {
  bool from_family = false;
  std::string model;  // empty: the one that ships
};

/// --from-family, which `about` explains, and --family-model.
void add_family(CLI::App& command, FamilyChoice& choice, const std::string& about);

/// Inclusive ends of the values that an option takes.
template <class Number>
struct Between {
  Number low, high;
};

/// An option of a number in a range; its help shows the range, and the value as the default.
template <class Number>
CLI::Option* add_number(
    CLI::App& command, const std::string& name, Number& value,
    std::type_identity_t<Between<std::conditional_t<std::is_integral_v<Number>, int, double>>> range,
    const std::string& about) {
  return command.add_option(name, value, about)->check(CLI::Range(range.low, range.high))->capture_default_str();
}

/// An option of several values, in one word with commas between them.
template <class Value>
CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<Value>& values,
                      const std::string& about) {
  return command.add_option(name, values, about + ", separated by commas")->delimiter(',')->allow_extra_args(false);
}

/// "{a,b,c}": the name of a value that is one of a few words.
std::string one_of(const std::vector<std::string>& words);

/// Ends the help of a command by a note, where there is one, and command lines; each command has at least one. A line
/// may continue after a backslash, indented by six blanks, and end with two blanks and a remark after #.
void add_examples(CLI::App& command, const std::vector<std::string>& lines, const std::string& note = "");

/// A line gonogo_command() of CMakeLists.txt.
struct CommandEntry {
  const char* name;
  void (*add)(CLI::App& program, const Globals& globals);  // add_<name>_command; null: left out with all its options
  const char* program;                                     // that does its work; empty: every program
  const char* left_out;  // option of CMake without which this build cannot do its work; empty: it can
};

/// All commands in the order of the help (commands.cpp.in).
std::span<const CommandEntry> all_commands();

template <class Value>
std::string name_in(const std::map<std::string, Value>& names, Value value) {
  for (const auto& [name, v] : names)
    if (v == value) return name;
  return "?";
}

/// An option whose value is one of `names`.
template <class Value>
void add_choice(CLI::App& command, const std::string& flag, Value& value, const std::map<std::string, Value>& names,
                const std::string& what) {
  std::vector<std::string> words;
  for (const auto& [name, v] : names) words.push_back(name);
  const auto set = [&value, names](const std::string& name) { value = names.at(name); };
  command.add_option_function<std::string>(flag, set, what)
      ->check(CLI::IsMember(words))
      ->default_str(name_in(names, value));
}

}  // namespace gonogo::app
