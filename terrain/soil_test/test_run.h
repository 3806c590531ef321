// What all virtual soil tests share: the soil under test, how tests are stepped, and what is watched meanwhile.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/io/capture.h"
#include "terrain/bed/numerics.h"

namespace gonogo::terrain {

/// Grains of one size with their contact laws, packed as the relative density asks.
struct TestSoil {
  double grain_diameter = 0.032;  // mean [m]
  GrainShape shape = GrainShape::sphere;
  sim::PairLaw grain{Real(0.5), 0, 0};
  double tool_friction = 0.5;     // of grains on plates, cones and walls that are not smooth [-]
  double relative_density = 0.5;  // 0: loosest, 1: densest packing
  double grain_density = 2650;    // of the solid [kg/m^3]
  std::uint64_t seed = 1;
  std::filesystem::path packing_folder;  // cache of settled beds; empty: none

  BedLaws laws() const { return {grain, {Real(tool_friction), 0, 0}}; }
};

/// Throws InputError for what cannot be tested: names the option, value and range.
void check(const TestSoil& soil);

/// Friction while settling that gives about this relative density; measured on spheres, see the source.
double settle_friction(double relative_density);
/// Its inverse.
double relative_density_of(double settle_friction);

/// Bed of this soil, `grains_*` diameters long, wide and deep, to be settled.
BedSpec test_bed_spec(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep);
/// Settled, or taken from the soil's folder of packings.
Packing test_bed(const TestSoil& soil, const BedSpec& spec, int threads);
Packing test_bed(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep, int threads);

/// How a test may use the machine, and whom it tells how far it is.
struct TestPace {
  int threads = 1;
  std::function<void(Index)> on_steps;  // called with the number of steps just taken, from the test's thread
  int substeps = 1, iterations = 200;   // of the solver in each step, and at most in each substep
  double tolerance = 0.01;              // residual at which it stops, in speeds of the test
  double residual = 0;                  // at which it stops, instead of `tolerance`, where above zero [m/s]
  sim::Target target = sim::Target::ccp;
};

/// The pace of a test with the numerics of trials, but for its step, which each kind of test has in units of its own.
TestPace pace_of(const Numerics& numerics);

/// Numerical parameters of the tests: bed_step_settings with a tolerance that follows the speed of the test [m/s].
/// Whole steps: in slow shear few updates in many substeps let the bed sink into itself (docs/soils.md).
sim::StepSettings test_settings(double grain_diameter, double step, double speed, const TestPace& pace);

/// Time in which gravity moves a grain by half its diameter, sqrt(d / g) [s].
double gravity_time(double grain_diameter);

/// Time in which a stress moves a grain by half its diameter, d sqrt(rho / sigma) [s].
double stress_time(double grain_diameter, double grain_density, double stress);

/// Of a tool that slides on vertical rails without friction [kg].
sim::BodyMass on_vertical_rails(double mass);

/// A world under test: steps it, stops on Ctrl-C, throws DeviceError when the engine raises a flag.
class TestRun {
 public:
  TestRun(std::string test, sim::SceneWorld world, const sim::StepSettings& settings, const TestPace& pace);

  void advance(Index steps);
  /// Mean contact force on a body over the next steps [N].
  Vec3d mean_force(sim::BodyIndex body, Index steps);
  std::vector<Vec3d> mean_forces(const std::vector<sim::BodyIndex>& bodies, Index steps);
  void set_velocity(sim::BodyIndex body, const Vec3& velocity);
  sim::BodyState body(sim::BodyIndex b) { return simulation_->body(0, b); }
  sim::Simulation& simulation() { return *simulation_; }

  const sim::SceneWorld& world() const { return world_; }
  sim::Capture capture() { return sim::capture_world(*simulation_, 0); }
  double worst_residual() const { return worst_residual_; }  // largest root-mean-square residual of a step [m/s]
  /// Root-mean-square speed of the first `count` bodies [m/s].
  double rms_speed(std::size_t count);

 private:
  std::string test_;
  sim::SceneWorld world_;
  TestPace pace_;
  std::unique_ptr<sim::Simulation> simulation_;
  double worst_residual_ = 0;
};

/// A test as it stood at its end, to be drawn.
struct TestScene {
  sim::SceneWorld world;
  sim::Capture end;
};

/// Runs job(0) .. job(count - 1), `threads` of them at a time. The first failure or Ctrl-C ends the rest and is thrown.
void run_jobs(std::size_t count, int threads, const std::function<void(std::size_t)>& job);

}  // namespace gonogo::terrain
