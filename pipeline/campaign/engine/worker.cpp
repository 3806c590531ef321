#include "pipeline/campaign/engine/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/error.h"
#include "base/files/file.h"
#include "base/version.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/ledger.h"

namespace gonogo::campaign {
namespace {

constexpr int kMillisecondsToEnd = 1000;

std::vector<std::string> worker_environment() {
  std::vector<std::string> result;
  for (char** entry = environ; *entry; ++entry)
    if (std::strncmp(*entry, "OMP_NUM_THREADS=", 16) != 0) result.push_back(*entry);
  result.push_back("OMP_NUM_THREADS=1");
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// Returns the process, or throws; `child_end` becomes its standard input and output.
pid_t spawn(std::vector<std::string> command, int child_end) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, child_end, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, child_end, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  std::vector<std::string> environment = worker_environment();
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, command.front().c_str(), &actions, &attributes, pointers(command).data(),
                                   pointers(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw DeviceError("campaign: cannot start " + command.front() + ": " + std::strerror(error));
  return pid;
}

/// Owns one child process and its line of communication. The destructor kills it.
class WorkerProcess {
 public:
  /// Throws DeviceError.
  explicit WorkerProcess(const std::vector<std::string>& command);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  int fd() const { return fd_; }
  /// A dead worker is noticed by the next receive(), not here.
  void send(const std::string& line);

  /// Reads what has come; false when the worker is gone. Lines are then taken one by one.
  bool receive();
  std::optional<std::string> take_line();

  /// How the process ended (waitpid's status), for a worker that receive() found gone. One that closed its line without
  /// ending is killed after a moment.
  int wait_for_end();

 private:
  void kill_now();

  pid_t pid_ = -1;
  int fd_ = -1, status_ = 0;
  std::string buffer_;
};

WorkerProcess::WorkerProcess(const std::vector<std::string>& command) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw DeviceError(std::string("campaign: cannot talk to a worker: ") + std::strerror(errno));
  fd_ = ends[0];
  try {
    pid_ = spawn(command, ends[1]);
  } catch (...) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw;
  }
  ::close(ends[1]);
}

WorkerProcess::~WorkerProcess() {
  kill_now();
  ::close(fd_);
}

void WorkerProcess::send(const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::send(fd_, line.data() + done, line.size() - done, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return;
    done += std::size_t(count);
  }
}

bool WorkerProcess::receive() {
  char bytes[16384];
  ssize_t count;
  do {
    count = ::read(fd_, bytes, sizeof bytes);
  } while (count < 0 && errno == EINTR);
  if (count <= 0) return false;
  buffer_.append(bytes, std::size_t(count));
  return true;
}

std::optional<std::string> WorkerProcess::take_line() {
  const std::size_t end = buffer_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  const std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

int WorkerProcess::wait_for_end() {
  for (int wait = 0; wait < kMillisecondsToEnd && pid_ >= 0; ++wait) {
    if (::waitpid(pid_, &status_, WNOHANG) == pid_)
      pid_ = -1;
    else
      ::usleep(1000);
  }
  kill_now();
  return status_;
}

void WorkerProcess::kill_now() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

/// "was killed by signal 11 (Segmentation fault)", "left with exit status 2".
std::string describe_end(int status) {
  if (WIFSIGNALED(status))
    return "was killed by signal " + std::to_string(WTERMSIG(status)) + " (" + ::strsignal(WTERMSIG(status)) + ")";
  return "left with exit status " + std::to_string(WEXITSTATUS(status));
}

/// True when a person or a kernel short of memory ended it rather than its own code.
bool killed_from_outside(int status) {
  return WIFSIGNALED(status) && (WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGTERM);
}

class ProcessCrew : public Crew {
 public:
  ProcessCrew(std::size_t size, WorkerCommand command) : command_(std::move(command)), workers_(size) {}

  std::size_t size() const override { return workers_.size(); }

  void send(std::size_t worker, const std::string& line) override {
    if (!workers_[worker]) workers_[worker] = std::make_unique<WorkerProcess>(command_(worker));
    workers_[worker]->send(line);
  }

  std::vector<CrewNews> wait(int milliseconds) override {
    std::vector<pollfd> lines;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i]) continue;
      lines.push_back({workers_[i]->fd(), POLLIN, 0});
      owner.push_back(i);
    }
    if (::poll(lines.data(), lines.size(), milliseconds) < 0) {
      if (errno == EINTR) return {};
      throw DeviceError(std::string("campaign: cannot wait for the workers: ") + std::strerror(errno));
    }
    std::vector<CrewNews> news;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i].revents != 0) news.push_back(hear(owner[i]));
    return news;
  }

 private:
  CrewNews hear(std::size_t number) {
    std::unique_ptr<WorkerProcess>& worker = workers_[number];
    CrewNews news;
    news.worker = number;
    news.gone = !worker->receive();
    while (std::optional<std::string> line = worker->take_line()) news.lines.push_back(std::move(*line));
    if (!news.gone) return news;
    const int status = worker->wait_for_end();
    news.killed_from_outside = killed_from_outside(status);
    news.end = describe_end(status);
    worker.reset();
    return news;
  }

  WorkerCommand command_;
  std::vector<std::unique_ptr<WorkerProcess>> workers_;
};

}  // namespace

std::unique_ptr<Crew> process_crew(std::size_t size, WorkerCommand command) {
  return std::make_unique<ProcessCrew>(size, std::move(command));
}

namespace {

/// Points come by standard input, results leave by a descriptor of their own.
class StandardLine : public WorkerLine {
 public:
  explicit StandardLine(int results) : results_(results) {}

  std::optional<std::string> next(bool wait) override {
    for (;;) {
      if (const std::size_t end = buffer_.find('\n'); end != std::string::npos) {
        const std::string line = buffer_.substr(0, end);
        buffer_.erase(0, end + 1);
        return line;
      }
      if (at_end_ || !(wait || is_ready(STDIN_FILENO, POLLIN))) return std::nullopt;
      receive();
    }
  }

  /// Goes on receiving meanwhile: the coordinator may be writing, too, and neither may wait for the other.
  void send(const std::string& line) override {
    for (std::size_t done = 0; done < line.size();) {
      if (!is_ready(results_, POLLOUT) && !at_end_ && is_ready(STDIN_FILENO, POLLIN)) receive();
      ssize_t count = ::send(results_, line.data() + done, line.size() - done, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (count < 0 && errno == ENOTSOCK) count = ::write(results_, line.data() + done, line.size() - done);
      if (count >= 0)
        done += std::size_t(count);
      else if (errno == EAGAIN)
        wait_for_change();
      else if (errno != EINTR)
        throw DeviceError(std::string("campaign worker: cannot reach the coordinator: ") + std::strerror(errno));
    }
  }

 private:
  static bool is_ready(int fd, short events) {
    pollfd one{fd, events, 0};
    return ::poll(&one, 1, 0) > 0;
  }

  void wait_for_change() const {
    pollfd ends[] = {{results_, POLLOUT, 0}, {STDIN_FILENO, POLLIN, 0}};
    ::poll(ends, at_end_ ? 1 : 2, -1);
  }

  void receive() {
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) return;
    if (count <= 0)
      at_end_ = true;
    else
      buffer_.append(bytes, std::size_t(count));
  }

  int results_;
  bool at_end_ = false;
  std::string buffer_;
};

std::string one_line(std::string sentence) {
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return sentence;
}

DesignPoint point_in(const std::string& line) {
  const std::optional<std::string_view> row = unseal_line(line);
  const std::optional<DesignPoint> point = row ? parse_point(*row) : std::nullopt;
  if (!point) throw InputError("campaign worker: its input holds no design points; it is started by a campaign");
  return *point;
}

/// Fills the engine and takes it one step on; false when nothing is left to do.
bool work(WorkerLine& line, TrialEngine& engine) {
  if (line.is_cancelled()) return false;
  while (engine.has_room()) {
    const std::optional<std::string> next = line.next(!engine.is_running());
    if (!next) break;
    engine.start(point_in(*next));
  }
  if (!engine.is_running()) return false;
  for (const TrialRecord& record : engine.advance()) line.send(kTrialWord + seal_line(to_row(record)));
  return true;
}

}  // namespace

std::string campaign_program() { return std::string(program_version()) + " (" + program_revision() + ")"; }

std::string worker_program() { return campaign_program() + ", contract " + content_hash(contract_text()); }

void run_worker(TrialEngine& engine, WorkerLine& line) {
  try {
    line.send(kHelloWord + seal_line(worker_program()));
    while (work(line, engine)) {
    }
  } catch (const InputError& error) {
    line.send(kRefusedWord + seal_line(one_line(error.what())));
  } catch (const DeviceError& error) {
    line.send(kFailedWord + seal_line(one_line(error.what())));
  }
}

void run_worker(TrialEngine& engine) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is the coordinator's to handle
  std::signal(SIGTERM, SIG_DFL);
  StandardLine line(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  run_worker(engine, line);
}

}  // namespace gonogo::campaign
