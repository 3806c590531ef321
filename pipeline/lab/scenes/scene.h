// Scenes of many bodies: simulated, shown, measured, then timed stage by stage.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/simulation/stages.h"

namespace gonogo::lab {

/// Backend and solver of a scene.
struct RunOn {
  sim::Solver solver = sim::Solver::apgd;  // of the run; scenes are made by the default one whatever is timed
  int iterations = 50;                     // of the solver in a step
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
};

/// A number that a scene measures.
struct Measured {
  std::string key;  // with its unit, as everywhere in JSON
  double value;
};

struct ManyScene {
  std::string name;
  sim::SceneWorld world;
  sim::StepSettings settings;
  double duration = 0;  // simulated before anything is timed [s]
  /// Called before the first step and then every kStepsPerDrive steps: sets loads, laws and bodies. May be empty.
  std::function<void(sim::Simulation&, double time)> drive;
  std::function<std::vector<Measured>(sim::Simulation&)> measure;  // after `duration`; may be empty
  /// Called at the start, every `watch_every` seconds and at the end. Its first number is the abscissa of plots. May be
  /// empty.
  std::function<std::vector<Measured>(sim::Simulation&, double time)> watch;
  double watch_every = 0.25;      // [s]
  bool show_by_material = false;  // in pictures spheres have the colours of their materials instead of their speeds
};

/// A watch with the time and then the numbers of `measure`.
std::function<std::vector<Measured>(sim::Simulation&, double time)> over_time(
    std::function<std::vector<Measured>(sim::Simulation&)> measure);

/// How soft penalty contact is.
struct Softness {
  double overlap = 0.05;       // largest, over the radius, after a fall through the height of the world [-]
  double restitution = 0.5;    // of an impact along the normal [-]
  double share_of_step = 0.9;  // of the critical step [-]
};

/// Gives a scene that the penalty family runs its law and step; leaves others as they are. Throws InputError for a
/// scene without spheres.
void set_penalty(ManyScene& scene, const Softness& softness);

/// Steps between two calls of a scene's drive.
inline constexpr int kStepsPerDrive = 10;

struct ManyRun {
  RunOn on;
  Softness softness;              // where the solver is of the penalty family; see set_penalty
  int repeats = 11;               // timed samples; 0: nothing is timed
  int steps_per_sample = 4;       // at most kStepsPerDrive
  std::filesystem::path vtk;      // folder of a VTK series, see sim/io/vtk_series.h; empty: not wanted
  std::filesystem::path picture;  // .png of the end, without what is fixed; empty: not wanted
  std::filesystem::path video;    // .mp4, the same way, by the program ffmpeg; its frames are held in memory
  std::filesystem::path plot;     // .png of what was watched
  double every = 0.1;             // simulated time between two frames [s]
};

struct ManyResult {
  std::int64_t bodies = 0, contacts = 0;  // contacts of the last step
  int iterations = 0;
  double build_seconds = 0;                    // from the call to the first step taken, the scene's own making excluded
  double run_seconds = 0;                      // wall clock for `duration`
  double ms_per_step = 0;                      // median, stages queued as in any run
  sim::StageTimes stages;                      // medians of steps taken stage by stage
  double ns_per_contact_iteration = 0;         // whole step over contacts times iterations
  double ns_per_contact_iteration_solver = 0;  // the solver's stage over contacts times iterations
  double residual_m_per_s = 0;                 // root mean square after the last step
  double copy_bandwidth = 0;                   // [B/s]
  double bandwidth_share = 0;                  // what the solver moves over what a copy would move meanwhile
  std::vector<Measured> measured;
  std::vector<std::vector<Measured>> watched;  // [look] the same keys in each
};

/// Throws InputError for a picture or video that this build or machine cannot make, before time is spent. Throws
/// DeviceError when a world raises a flag.
ManyResult run_many(const ManyScene& scene, const ManyRun& run);

/// Median of each stage.
sim::StageTimes median_times(const std::vector<sim::StageTimes>& samples);

}  // namespace gonogo::lab
