// Runs the built program the way a person does: words in, exit code and two streams of text out.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo {

struct Ending {
  int exit_code = -1;  // -1 when a signal ended the program
  int signal = 0;
  std::string out, err;
};

struct RunOptions {
  std::function<void()> before;  // in the new process, before the program starts: limits, another user
  /// Sends `signal` as soon as `when` answers true (asked every few milliseconds).
  int signal = 0;
  std::function<bool()> when;
};

/// Runs gonogo with `words`; fails the test when it has not ended after five minutes.
Ending run_gonogo(const std::vector<std::string>& words, const RunOptions& options = {});

/// The promise of every refusal: this exit code, and a last line on stderr that starts with "gonogo: ", holds every
/// part and is the only such line. Nothing on stdout.
void check_refusal(const Ending& ending, int exit_code, const std::vector<std::string>& parts);

/// The same under --json: the last line of stdout is an object whose member "error" has this kind and the sentence of
/// stderr. Returns that member.
Json check_json_refusal(const Ending& ending, int exit_code, const std::string& kind,
                        const std::vector<std::string>& parts);

/// The built program.
std::filesystem::path gonogo_program();

/// Files below `folder` (relative paths, sorted); hidden ones too.
std::vector<std::string> files_below(const std::filesystem::path& folder);

/// No file below `folder` has the name of a partial one.
void check_nothing_half_written(const std::filesystem::path& folder);

/// To be called in RunOptions::before: an ordinary user, also when the tests run as root.
void become_ordinary_user();

/// To be called in RunOptions::before: no file can grow beyond `bytes`; writing more fails as on a full disk.
void limit_file_size(std::size_t bytes);

}  // namespace gonogo
