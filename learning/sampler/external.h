// Parts of the samplers whose rows come from outside.
#pragma once
#include <string>
#include <vector>

namespace gonogo::learning {

struct ProcessResult {
  int exit_status = -1;    // of a program that exited
  int signal = 0;          // that ended it; 0: none
  bool timed_out = false;  // it and all its children were killed
  std::string error_text;  // the last 4,000 bytes of its stderr
};

/// Runs another program to its end, without a shell and with a time limit. stdin is empty, stdout is dropped. Throws
/// InputError when the program cannot be started. On Ctrl-C kills the program's process group and throws Cancelled.
ProcessResult run_process(const std::vector<std::string>& arguments, double time_limit_s);

}  // namespace gonogo::learning
