// Another program, run to its end: argument vector, no shell, a time limit.
#pragma once
#include <string>
#include <vector>

namespace gonogo::learning {

struct ProcessResult {
  int exit_status = -1;    // of a program that ended by itself
  int signal = 0;          // that ended it otherwise
  bool timed_out = false;  // it was killed, with everything it had started
  std::string error_text;  // the last 4,000 bytes of its stderr
};

/// stdin is empty, stdout is dropped. Throws InputError when the program cannot be started, Cancelled on Ctrl-C, after
/// the program's group of processes was killed.
ProcessResult run_process(const std::vector<std::string>& arguments, double time_limit_s);

}  // namespace gonogo::learning
