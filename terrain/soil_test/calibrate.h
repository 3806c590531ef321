// Measures a calibration table by virtual tests: triaxial compression with and without contact cohesion, plate sinkage,
// cones and loosest packing. They cover a line of contact parameters and the packings of the library.
#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// Results of finished tests by name, in one JSON file that is replaced as a whole after every test.
class TestJournal {
 public:
  /// `maker` describes all that the results depend on, apart from the tests' names. Throws InputError for a file of
  /// another maker.
  TestJournal(std::filesystem::path path, std::string maker);

  std::optional<std::vector<double>> find(const std::string& test) const;
  /// Thread-safe.
  void add(const std::string& test, const std::vector<double>& numbers);
  std::size_t size() const { return result_.size(); }

 private:
  void save() const;

  std::filesystem::path path_;
  std::string maker_;
  std::map<std::string, std::vector<double>> result_;
  mutable std::mutex mutex_;
};

struct CalibrationRun {
  double grain_diameter = 0.032;  // of the sphere with a grain's volume [m]
  GrainShape shape = GrainShape::sphere;
  sim::Backend device = sim::Backend::cpu;  // cuda: all tests in one batch
  int threads = 1;                          // number of tests at a time on the CPU
  int seeds = 3;                            // number of packings of each density
  /// Number of packings of each density whose friction angle is measured; at least `seeds`. Angles of rough specimens
  /// differ by two degrees, so they need more packings than cohesion and plates do.
  int angle_seeds = 3;
  /// Measures only contact levels whose sliding friction lies in this range; at least two levels. For tables of a
  /// narrow range of angles, or with expensive numerics.
  std::pair<double, double> friction_range{0, 10};
  Numerics numerics;  // of the trials that will use the table: less accurate contacts make another soil
  /// File of finished tests, from which an interrupted run continues. Empty: none is written.
  std::filesystem::path journal;
};

/// The `maker` of this run's journal.
std::string journal_maker(const CalibrationRun& run);
/// Names of this run's tests in the journal.
std::vector<std::string> calibration_tests(const CalibrationRun& run);

/// Runs the tests that the journal lacks. The table does not depend on the number of threads or on interruptions.
/// Throws Cancelled on Ctrl-C, InputError for a journal of another run.
Calibration calibrate(const CalibrationRun& run);

/// Presses cones into the packings of each contact level of a table, `run.seeds` of each, and writes the gradients of
/// their indices into it. Grain size, shape and numerics of `run` are the table's. A packing in which more than a third
/// of the cones fail stays without. Throws as calibrate() does, and InputError for tables without angles on the plane
/// of shear.
void add_cones(Calibration& table, const CalibrationRun& run);

}  // namespace gonogo::terrain
