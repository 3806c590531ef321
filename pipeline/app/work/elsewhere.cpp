#include "pipeline/app/work/elsewhere.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "base/cancel.h"

namespace gonogo::app {
namespace fs = std::filesystem;

void continue_in(const std::string& program, const Globals& globals) {
  stop_if_cancelled();
  const fs::path self = fs::read_symlink("/proc/self/exe");
  fs::path file = self.parent_path() / program;
  std::error_code unreadable;
  if (!fs::exists(file, unreadable)) file = self.parent_path() / GONOGO_LIBEXEC / program;
  if (file == self) throw DeviceError(self.string() + ": does not hold this work itself; build or install it again");
  std::vector<char*> words;
  for (const std::string& word : globals.command_line) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  std::fflush(nullptr);
  ::execv(file.c_str(), words.data());
  throw DeviceError(file.string() + ": cannot be started: " + std::strerror(errno) +
                    "; it belongs to this program, install both again");
}

}  // namespace gonogo::app
