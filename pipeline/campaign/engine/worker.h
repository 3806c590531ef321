// Both ends of the line between a coordinator and its workers.
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

/// What was heard of one worker.
struct CrewNews {
  std::size_t worker = 0;
  std::vector<std::string> lines;
  bool gone = false;                 // it ended; the next send() to it starts another one
  bool killed_from_outside = false;  // by a person or a kernel short of memory, rather than by its own code
  std::string end;                   // "was killed by signal 9 (Killed)"
};

/// Workers as the coordinator sees them: numbered, they get lines of text and answer with lines. They are processes of
/// this machine or ranks of an MPI job (cluster/mpi_crew.h). The destructor ends them.
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

/// Program and arguments of a process that calls run_worker, the `worker`-th of its crew.
using WorkerCommand = std::function<std::vector<std::string>(std::size_t worker)>;

/// Processes of this machine, each with one thread for OpenMP and a process group of its own, so that Ctrl-C reaches
/// the coordinator alone.
std::unique_ptr<Crew> process_crew(std::size_t size, WorkerCommand command);

// The worker's side: points in, trials out, one sealed line each.

/// Computes trials, some of them side by side. A trial is a pure function of its point: the same bits in any process,
/// however often it runs. A failed simulation is a record with the verdict unknown. Throws InputError or DeviceError
/// only for a fault that every trial would meet. The campaign then stops with that sentence, and the engine is not
/// called again.
class TrialEngine {
 public:
  virtual ~TrialEngine() = default;
  virtual bool has_room() const = 0;
  virtual bool is_running() const = 0;
  virtual void start(const DesignPoint& point) = 0;
  /// Advances the running trials for a moment and returns those that ended.
  virtual std::vector<TrialRecord> advance() = 0;
};

/// The worker's end of its connection to the coordinator.
class WorkerLine {
 public:
  virtual ~WorkerLine() = default;
  /// The next line; empty at the end of input, and without `wait` also when no line is there yet.
  virtual std::optional<std::string> next(bool wait) = 0;
  virtual void send(const std::string& line) = 0;
  /// True when the coordinator has cancelled the running trials.
  virtual bool is_cancelled() { return false; }
};

/// Computes points until `line` ends, keeping the engine full.
void run_worker(TrialEngine& engine, WorkerLine& line);

/// The same over standard input and output. Whatever a trial prints to standard output goes to standard error. Ends
/// with the coordinator, however that ends.
void run_worker(TrialEngine& engine);

/// Release and revision of this program, as provenance names it.
std::string campaign_program();
/// The same and the contract; coordinator and workers must agree in it.
std::string worker_program();

// Lines from worker to coordinator start with one of these words.
inline constexpr const char* kHelloWord = "hello ";  // then worker_program(); the first line
inline constexpr const char* kTrialWord = "trial ";
inline constexpr const char* kRefusedWord = "refused ";  // then the sentence of an InputError
inline constexpr const char* kFailedWord = "failed ";    // then the sentence of a DeviceError

}  // namespace gonogo::campaign
