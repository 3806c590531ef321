// A worker process as the coordinator sees it.
#pragma once
#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace gonogo::campaign {

/// Owns one child process and its line of communication. The destructor kills it.
class WorkerProcess {
 public:
  /// Starts `command` (program and arguments) with one thread for OpenMP, in a process group of its own, so that Ctrl-C
  /// reaches the coordinator alone. Throws DeviceError.
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

/// "was killed by signal 11 (Segmentation fault)", "left with exit status 2".
std::string describe_end(int status);

/// True when a person or a kernel short of memory ended it rather than its own code.
bool killed_from_outside(int status);

}  // namespace gonogo::campaign
