// The worker's side of a campaign: points in, trials out, one sealed line each.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/campaign/trial/record.h"

namespace gonogo::campaign {

/// A trial is a pure function of its point: the same bits in any process, however often it runs. Throws InputError or
/// DeviceError only for a fault that every trial would meet; the campaign stops with that sentence. A failed simulation
/// is a record with the verdict unknown.
using TrialFunction = std::function<TrialRecord(const DesignPoint&)>;

/// Computes trials, some of them side by side. Throws as TrialFunction, and must not be called again then.
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
/// The same with one trial at a time.
void run_worker(const TrialFunction& trial);
void run_worker(const TrialFunction& trial, WorkerLine& line);

/// Version of program and contract; coordinator and workers must agree in it.
std::string worker_program();

// Lines from worker to coordinator start with one of these words.
inline constexpr const char* kHelloWord = "hello ";  // then worker_program(); the first line
inline constexpr const char* kTrialWord = "trial ";
inline constexpr const char* kRefusedWord = "refused ";  // then the sentence of an InputError
inline constexpr const char* kFailedWord = "failed ";    // then the sentence of a DeviceError

}  // namespace gonogo::campaign
