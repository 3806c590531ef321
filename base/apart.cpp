#include "base/apart.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>

#include "base/error.h"
#include "base/progress.h"

namespace gonogo {
namespace {

using Clock = std::chrono::steady_clock;

enum class Answer : char { done = 'd', refused = 'r', out_of_memory = 'm' };  // the first byte of the answer

/// Address space of this process [byte]; 0 if unknown.
std::size_t address_space() {
  unsigned long pages = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "re");
  if (!file) return 0;
  if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
  std::fclose(file);
  return pages * std::size_t(sysconf(_SC_PAGESIZE));
}

void limit_to(int resource, rlim_t most) {
  rlimit limit{};
  getrlimit(__rlimit_resource_t(resource), &limit);
  limit.rlim_cur = std::min(limit.rlim_max, most);
  setrlimit(__rlimit_resource_t(resource), &limit);
}

/// Handlers of the host (Python's among them) are for its own process.
void restore_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGALRM, SIGPIPE})
    std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
}

void write_all(int fd, const char* at, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(fd, at, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) _exit(1);
    at += written;
    size -= std::size_t(written);
  }
}

[[noreturn]] void work_in_child(const std::function<std::string()>& work, int out, pid_t parent, std::size_t memory) {
  restore_signals();
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  limit_to(RLIMIT_CORE, 0);
  if (memory > 0) limit_to(RLIMIT_AS, memory);
  const int quiet = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (quiet >= 0) ::dup2(quiet, STDERR_FILENO);  // where the C library prints why it aborts
  Answer answer = Answer::done;
  std::string bytes;
  try {
    bytes = work();
  } catch (const InputError& error) {
    answer = Answer::refused;
    bytes = error.what();
  } catch (const std::bad_alloc&) {
    answer = Answer::out_of_memory;
    bytes.clear();
  } catch (...) {
    std::abort();
  }
  const char first = char(answer);
  write_all(out, &first, 1);
  write_all(out, bytes.data(), bytes.size());
  _exit(0);
}

/// A child that is ended and waited for.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() { end(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Whether it ended by itself, without an error.
  bool wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  void end() {
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }

 private:
  pid_t pid_;
};

/// Everything that comes out of the pipe until it is closed; false when the time is over.
bool read_until(int fd, Clock::time_point end, std::string& bytes) {
  constexpr std::chrono::milliseconds glance(50);
  std::string part(std::size_t(1) << 16, '\0');
  for (;;) {
    stop_if_cancelled();
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0) return false;
    pollfd one{fd, POLLIN, 0};
    const int ready = ::poll(&one, 1, int(std::min(left, glance).count()));
    if (ready <= 0) continue;
    const ssize_t size = ::read(fd, part.data(), part.size());
    if (size == 0) return true;
    if (size > 0) bytes.append(part, 0, std::size_t(size));
  }
}

struct Pipe {
  std::array<int, 2> end{-1, -1};
  Pipe() {
    if (::pipe2(end.data(), O_CLOEXEC) != 0)
      throw DeviceError(std::string("pipe for a child process: ") + std::strerror(errno));
  }
  ~Pipe() {
    for (const int fd : end)
      if (fd >= 0) ::close(fd);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_writing() {
    ::close(end[1]);
    end[1] = -1;
  }
};

}  // namespace

ApartResult call_apart(const std::function<std::string()>& work, const ApartLimits& limits) {
  const Clock::time_point end = Clock::now() + limits.time;
  const std::size_t held = address_space();
  Pipe pipe;
  const pid_t parent = getpid(), pid = ::fork();
  if (pid < 0) throw DeviceError(std::string("fork of this process to read a file: ") + std::strerror(errno));
  if (pid == 0) work_in_child(work, pipe.end[1], parent, held > 0 ? held + limits.memory : 0);
  Child child(pid);
  pipe.close_writing();
  std::string bytes;
  if (!read_until(pipe.end[0], end, bytes)) return {ApartEnd::out_of_time};
  if (!child.wait() || bytes.empty()) return {ApartEnd::crashed};
  const auto answer = Answer(bytes.front());
  bytes.erase(0, 1);
  if (answer == Answer::out_of_memory) return {ApartEnd::out_of_memory};
  if (answer == Answer::refused) return {.refusal = std::move(bytes)};
  return {.bytes = std::move(bytes)};
}

}  // namespace gonogo
