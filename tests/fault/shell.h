// Command lines run by a shell: how they end and all that they say.
#pragma once
#include <sys/wait.h>

#include <cstdio>
#include <string>

namespace gonogo {

struct ShellEnding {
  int status = -1;
  std::string output;
};

inline ShellEnding shell(const std::string& command) {
  ShellEnding ending;
  std::FILE* pipe = ::popen(("(" + command + ") 2>&1").c_str(), "re");
  if (!pipe) return ending;
  char bytes[4096];
  for (std::size_t count; (count = std::fread(bytes, 1, sizeof bytes, pipe)) > 0;) ending.output.append(bytes, count);
  const int status = ::pclose(pipe);
  ending.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ending;
}

}  // namespace gonogo
