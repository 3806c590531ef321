// Where the time of a step goes, and the search for contacts by itself: for measurements, apart from what users of a
// simulation need.
#pragma once
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// Of a step, in this order; see sim/simulation/step.h. Lists: which contacts act on a body, and tiles of contacts.
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

  /// Takes one step of all worlds and waits for the device behind every stage; the same bits as advance(1).
  virtual StageTimes timed_step() = 0;
  /// Finds all contacts where the bodies are now and writes their gaps, normals and points, but takes no step.
  /// contacts(), impulses() and contact_force() are empty until the next one.
  virtual SearchReport timed_search() = 0;
  /// Bytes that one update of the latest step's contacts and of their bodies moves to and from memory when every record
  /// that it needs is moved once. Caches hold records of few bodies between two updates and spare the memory.
  virtual double solver_traffic() = 0;
};

/// The same simulation, seen stage by stage.
StepByStage& by_stage(Simulation& simulation);

/// Bytes per second read and written while a large array is copied: a yardstick of the device's memory. Throws as
/// require_backend does.
double copy_bandwidth(Backend backend, int threads);
double cpu_copy_bandwidth(int threads);
double cuda_copy_bandwidth();

}  // namespace gonogo::sim
