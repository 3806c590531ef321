#include "learning/sampler/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "base/cancel.h"
#include "base/error.h"

namespace gonogo::learning {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptText = 4000;

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw DeviceError(std::string("pipe: ") + std::strerror(errno));
    read = ends[0];
    write = ends[1];
  }
  ~Pipe() {
    ::close(read);
    if (write >= 0) ::close(write);
  }
};

pid_t start(const std::vector<std::string>& arguments, const Pipe& error) {
  std::vector<char*> list;
  for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
  list.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, error.write, STDERR_FILENO);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // a group of its own, so that its children end with it
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t pid = 0;
  const int status = ::posix_spawnp(&pid, list[0], &actions, &attributes, list.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (status != 0) throw InputError("command \"" + arguments[0] + "\" cannot be started: " + std::strerror(status));
  return pid;
}

void keep_tail(std::string& text, const char* bytes, std::size_t count) {
  text.append(bytes, count);
  if (text.size() > kKeptText) text.erase(0, text.size() - kKeptText);
}

/// Reads what is there now, waiting at most 50 ms.
void read_some(int pipe, std::string& text) {
  pollfd poll{pipe, POLLIN, 0};
  if (::poll(&poll, 1, 50) <= 0) return;
  char bytes[4096];
  const ssize_t count = ::read(pipe, bytes, sizeof bytes);
  if (count > 0)
    keep_tail(text, bytes, std::size_t(count));
  else
    ::usleep(10'000);  // the program has closed its stderr and runs on
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& arguments, double time_limit_s) {
  if (arguments.empty() || arguments[0].empty()) throw InputError("command: no program is given");
  Pipe error;
  const pid_t pid = start(arguments, error);
  ::close(error.write);
  error.write = -1;
  const auto begin = Clock::now();
  ProcessResult result;
  bool cancelled = false;
  int status = 0;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    read_some(error.read, result.error_text);
    cancelled = cancelled || cancel_requested();
    result.timed_out = std::chrono::duration<double>(Clock::now() - begin).count() > time_limit_s;
    if (!cancelled && !result.timed_out) continue;
    ::kill(-pid, SIGKILL);
    ::waitpid(pid, &status, 0);
    break;
  }
  ::kill(-pid, SIGKILL);  // what it may have left behind
  char bytes[4096];
  ::fcntl(error.read, F_SETFL, O_NONBLOCK);
  for (ssize_t count; (count = ::read(error.read, bytes, sizeof bytes)) > 0;)
    keep_tail(result.error_text, bytes, std::size_t(count));
  if (cancelled) stop_if_cancelled();
  if (WIFEXITED(status)) result.exit_status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  return result;
}

}  // namespace gonogo::learning
