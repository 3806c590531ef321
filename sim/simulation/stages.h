// Measurements of a simulation: the time of each stage of a step, and the search for contacts by itself.
#pragma once
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// Stages of a step, in order; see step.h. `lists`: the contacts of each body, and tiles of contacts.
enum class Stage { bins, contacts, lists, motion, forces, solve, integrate };
inline constexpr int kStageCount = 7;
inline constexpr const char* kStageNames[kStageCount] = {"bins",   "contacts", "lists",    "motion",
                                                         "forces", "solve",    "integrate"};

struct StageTimes {
  double seconds[kStageCount] = {};  // [stage], wall clock

  double of(Stage stage) const { return seconds[int(stage)]; }
};

/// What a search for the contacts of all worlds found, and how long it took.
struct SearchReport {
  Index contact_count = 0;
  StageTimes times;  // bins and contacts
};

class StepByStage {
 public:
  virtual ~StepByStage() = default;

  /// Takes one step of all worlds and waits for the device after every stage. The same bits as advance(1).
  virtual StageTimes timed_step() = 0;
  /// Finds all contacts at the bodies' present positions, but takes no step. contacts(), impulses() and contact_force()
  /// are empty until the next step.
  virtual SearchReport timed_search() = 0;
  /// Bytes that one update of the latest step's contacts and bodies moves, if every record is moved once. Caches may
  /// move fewer to and from memory.
  virtual double solver_traffic() = 0;
};

/// The same object, as StepByStage.
StepByStage& by_stage(Simulation& simulation);

/// Bytes per second read and written while a large array is copied. Throws as require_backend does.
double copy_bandwidth(Backend backend, int threads);
double cpu_copy_bandwidth(int threads);
double cuda_copy_bandwidth();

}  // namespace gonogo::sim
