#include "pipeline/app/cli/work.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "base/progress.h"
#include "pipeline/app/cli/table.h"

namespace gonogo::app {
namespace fs = std::filesystem;
namespace {

/// The registry line of the command, or of the one above it.
const CommandEntry& entry_of(const CLI::App& command) {
  const CLI::App* top = &command;
  while (top->get_parent()->get_parent() != nullptr) top = top->get_parent();
  for (const CommandEntry& entry : all_commands())
    if (entry.name == top->get_name()) return entry;
  throw DeviceError(top->get_name() + ": is in no line of CMakeLists.txt");
}

/// From here on SIGINT and SIGTERM wait until install_cancel_handler() of the next program takes them.
void hold_cancel_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
}

[[noreturn]] void continue_in(const std::string& program, const Globals& globals) {
  hold_cancel_signals();
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

}  // namespace

std::string left_out_by(const CLI::App& command) { return entry_of(command).left_out; }

void do_elsewhere(const CLI::App& command, const Globals& globals) {
  const CommandEntry& entry = entry_of(command);
  const std::string option = entry.left_out, name = full_name(command);
  if (!option.empty())
    throw InputError(name.substr(name.find(' ') + 1) + ": left out of this build (" + option +
                     "=OFF); configure with -D" + option + "=ON and build again");
  continue_in(entry.program, globals);
}

}  // namespace gonogo::app
