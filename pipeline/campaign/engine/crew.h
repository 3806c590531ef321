// Workers as the coordinator sees them: numbered, they get lines of text and answer with lines.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gonogo::campaign {

/// What was heard of one worker.
struct CrewNews {
  std::size_t worker = 0;
  std::vector<std::string> lines;
  bool gone = false;                 // it ended; the next send() to it starts another one
  bool killed_from_outside = false;  // by a person or a kernel short of memory, rather than by its own code
  std::string end;                   // "was killed by signal 9 (Killed)"
};

/// One engine's workers: processes of this machine (process_crew.h) or ranks of an MPI job (mpi/mpi_crew.h).
/// The destructor ends them.
class Crew {
 public:
  virtual ~Crew() = default;
  virtual std::size_t size() const = 0;
  /// Starts the worker when there is none. Throws DeviceError when that is impossible.
  virtual void send(std::size_t worker, const std::string& line) = 0;
  /// Waits at most so long for anything to be heard.
  virtual std::vector<CrewNews> wait(int milliseconds) = 0;
};

/// Makes a crew of at most `max_workers` workers.
using CrewMaker = std::function<std::unique_ptr<Crew>(std::size_t max_workers)>;

}  // namespace gonogo::campaign
