// A worker process as the coordinator sees it.
#pragma once
#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

/// Owns one child process, its line of communication and the trials it is at. The destructor kills it.
class WorkerProcess {
 public:
  /// Starts `command` (program and arguments) with one thread for OpenMP, in a process group of its own, so that Ctrl-C
  /// reaches the coordinator alone. Throws DeviceError.
  explicit WorkerProcess(const std::vector<std::string>& command);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  int fd() const { return fd_; }
  /// Trials that it has been given and not answered, in the order in which it was given them.
  const std::vector<const DesignPoint*>& trials() const { return trials_; }

  /// Hands out a trial, which must outlive it. A worker that is dead already shows that when it is read.
  void start(const DesignPoint& point);
  void finish(const DesignPoint& point) { std::erase(trials_, &point); }

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
  std::vector<const DesignPoint*> trials_;
  std::string buffer_;
};

/// "was killed by signal 11 (Segmentation fault)", "left with exit status 2".
std::string describe_end(int status);

/// Whether somebody outside (a person, the kernel short of memory) ended it, rather than its own code.
bool killed_from_outside(int status);

}  // namespace gonogo::pipeline
