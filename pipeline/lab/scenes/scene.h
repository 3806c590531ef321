// Scenes of many bodies: simulated, shown, measured, then timed stage by stage.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipeline/report/picture/render.h"
#include "sim/io/capture.h"
#include "sim/simulation/simulation.h"

namespace gonogo::lab {

/// Backend and solver of a scene.
struct RunOn {
  sim::ContactMethod solver{};  // of the run; scenes are made by the default one whatever is timed
  int iterations = 50;          // of the solver in a step
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  int gpus = 1;  // over which the world is divided
};

/// A number that a scene measures.
struct SceneNumber {
  std::string key;  // with its unit, as everywhere in JSON
  double value;
};

struct ManyScene {
  std::string name;
  sim::SceneWorld world{};
  sim::StepSettings settings;
  double duration = 0;  // simulated before anything is timed [s]
  /// Called before the first step and then every kStepsPerDrive steps: sets loads, laws and bodies. May be empty.
  std::function<void(sim::Simulation&, double time)> drive{};
  std::function<std::vector<SceneNumber>(sim::Simulation&)> measure{};  // after `duration`; may be empty
  /// Called at the start, every `watch_every` seconds and at the end. Its first number is the abscissa of plots. May be
  /// empty.
  std::function<std::vector<SceneNumber>(sim::Simulation&, double time)> watch{};
  double watch_every = 0.25;      // [s]
  bool show_by_material = false;  // in pictures spheres have the colours of their materials instead of their speeds
};

/// A watch with the time and then the numbers of `measure`.
std::function<std::vector<SceneNumber>(sim::Simulation&, double time)> over_time(
    std::function<std::vector<SceneNumber>(sim::Simulation&)> measure);

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

inline constexpr double kPacked = 0.6;  // solid fraction of settled spheres, about
inline constexpr int kSegments = 48;    // of round walls
/// While spheres settle. With the friction that they have later they pack less densely, and the rows of a lattice would
/// stand on each other as they are.
inline constexpr double kSettlingFriction = 0.1;

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
  std::vector<SceneNumber> measured;
  std::vector<std::vector<SceneNumber>> watched;  // [look] the same keys in each
};

/// Throws InputError for a picture or video that this build or machine cannot make, before time is spent. Throws
/// DeviceError when a world raises a flag.
ManyResult run_many(const ManyScene& scene, const ManyRun& run);

/// Median of each stage.
sim::StageTimes median_times(const std::vector<sim::StageTimes>& samples);

// Spheres that do not touch yet, to be settled, and what the scenes of many spheres have in common.

/// Spheres of the scenes of many bodies.
struct Spheres {
  Index count = 16'000;       // exactly so many
  double diameter = 0.04;     // mean [m]
  double size_spread = 0.05;  // radii are uniform in mean * (1 +- spread), so that no crystal forms
  double density = 2600;      // of the solid [kg/m^3]
  double friction = 0.3;      // among spheres and of walls [-]
  std::uint64_t seed = 1;

  double largest_diameter() const { return diameter * (1 + size_spread); }
  /// Distance of the lattice's columns: no two spheres overlap, whatever their draws [m].
  double pitch() const { return 1.01 * largest_diameter(); }
};

struct Sphere {
  Vec3d centre;   // [m]
  double radius;  // [m]
};

/// Spheres of a cubic lattice from the lower corner upward, x fastest, each shifted a little so that columns buckle.
/// Only places that `inside` accepts are taken, at most `max_count` of them.
std::vector<Sphere> loose_lattice(const Spheres& spec, const Vec3d& corner, Index nx, Index ny, Index nz,
                                  const std::function<bool(const Vec3d&)>& inside, std::size_t max_count);

/// All of them, loose in an upright cylinder of this inner radius that stands on the origin.
std::vector<Sphere> loose_column(const Spheres& spec, double radius);

/// A fixed body with a mesh, in the group of walls.
sim::BodyIndex add_wall(sim::SceneWorld& world, sim::TriangleMesh mesh, int material = 0);

/// Numerics for spheres of this diameter; step 2e-3 s. The envelope gives about 3.6 contacts per sphere; the published
/// tank has 3.55.
sim::StepSettings many_step_settings(const Spheres& spec, int iterations, const sim::ContactMethod& solver = {});

/// Adds a plane to a body, through `at`, with its normal along the z axis turned by `turn`.
void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn);

/// Turns the z axis, along which a plane looks, into x, -x (axis 0), y or -y (axis 1).
Quat towards(int axis, double sign);

/// Time of a fall from this height [s].
double fall_time(double height);

/// Height of the highest point [m].
double height_of(const std::vector<Sphere>& spheres);

// A scene of many bodies as pictures and as a video.

/// Throws InputError in a build without pictures and, for a video, on a machine without ffmpeg.
void require_pictures(bool video);

/// Camera and colour bar.
struct SnapshotView {
  report::Camera camera;
  double high_speed = 1;  // upper end of the colour bar [m/s]
};

/// A view that holds all of these states. In three of four of them, one body in twenty is faster than the bar's upper
/// end.
SnapshotView view_of(const ManyScene& scene, const std::vector<const sim::Capture*>& states);

/// Writes a PNG with spheres in the colours of their speed or material. Fixed bodies, walls and floors, are left out:
/// they would hide the rest.
void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state,
                   const SnapshotView& view, int threads);

/// Writes a PNG of curves: everything but the first number of a look over the first.
void draw_watched(const std::filesystem::path& path, const ManyScene& scene,
                  const std::vector<std::vector<SceneNumber>>& watched);

/// Pictures per second of a video of `count` states, `every` seconds apart: real time, or slower so that the video
/// takes six seconds, but at least five pictures per second.
double frame_rate(int count, double every);

/// Writes an MP4 of states that are `every` seconds apart, at that rate.
void draw_video(const std::filesystem::path& path, const ManyScene& scene, const std::vector<sim::Capture>& states,
                double every, int threads);

// Times of steps.

/// Wall clock [s].
double seconds();

double median(std::vector<double> values);

/// Median time of a step, each of `repeats` samples taken over `steps_per_sample` steps that nothing interrupts [s].
double seconds_per_step(sim::Simulation& simulation, int repeats, int steps_per_sample);

}  // namespace gonogo::lab
