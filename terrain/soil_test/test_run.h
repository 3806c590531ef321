// Shared by all virtual soil tests: the soil under test, its bed, the numerics, a world that is stepped and checked,
// and lines through what was measured.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/math/statistics.h"
#include "sim/io/capture.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil_test/test_bench.h"

namespace gonogo::terrain {

/// A weighted least-squares line through measured points.
struct LineFit {
  double intercept = 0, slope = 0;
  double intercept_error = 0, slope_error = 0;  // standard errors, from the scatter about the line
  double r2 = 0;                                // share of the variance of y that the line explains
};

/// y = intercept + slope x. Empty `weight`: equal weights. Needs three points at two values of x. Standard errors as in
/// Press et al., Numerical Recipes, section 15.2, with the variance estimated from the residuals.
LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& weight = {});

/// An angle from its tangent or sine, with its standard error.
Angle angle_of_tangent(double tangent, double error);
Angle angle_of_sine(double sine, double error);

/// Grains of one size, with contact laws and relative density.
struct TestSoil {
  double grain_diameter = 0.032;  // mean [m]
  GrainShape shape = GrainShape::sphere;
  sim::PairLaw grain{Real(0.5), 0, 0};
  double tool_friction = 0.5;     // of grains on plates, cones and rough walls [-]
  double relative_density = 0.5;  // 0: loosest packing, 1: densest
  double grain_density = 2650;    // of the solid [kg/m^3]
  std::uint64_t seed = 1;
  std::filesystem::path packing_folder;  // cache of settled beds; empty: none
  sim::Backend settled_on = sim::Backend::cpu;

  BedLaws laws() const { return {grain, {Real(tool_friction), 0, 0}}; }
};

/// Throws InputError, with option, value and range, for soils that cannot be tested.
void check(const TestSoil& soil);

/// Friction while settling that gives about this relative density, by measurements on spheres (in the .cpp).
double settle_friction(double relative_density);
/// Inverse of settle_friction.
double relative_density_of(double settle_friction);

/// Spec of a bed of this soil, `grains_*` diameters long, wide and deep.
BedSpec test_bed_spec(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep);
/// Settles a bed, or reads it from the soil's packing folder.
Packing test_bed(const TestSoil& soil, const BedSpec& spec, int threads);
Packing test_bed(const TestSoil& soil, double grains_long, double grains_wide, double grains_deep, int threads);

/// Threads, progress callback and solver settings of a test.
struct TestPace {
  int threads = 1;
  std::function<void(Index)> on_steps;  // called from the test's thread with the number of new steps
  int substeps = 1, iterations = 200;   // substeps of a step; max iterations of a substep
  double tolerance = 0.01;              // residual at which the solver stops, over the speed of the test
  double residual = 0;                  // the same in [m/s]; replaces `tolerance` if above zero
  sim::Target target = sim::Target::ccp;
  double give = 0;             // of contacts, see Numerics
  TestBench* bench = nullptr;  // where the test's worlds are stepped; null: each in a simulation on the CPU
};

/// Pace with the numerics of trials. The step is not part of it: each kind of test has its own.
TestPace pace_of(const Numerics& numerics);

/// Solver settings of a test: bed_step_settings with a tolerance in proportion to the speed of the test [m/s]. The
/// default pace has one substep: with few updates in many substeps, slow shear lets grains sink into each other
/// (docs/soils.md).
sim::StepSettings test_settings(double grain_diameter, double step, double speed, const TestPace& pace);

/// Time in which gravity moves a grain by half its diameter, sqrt(d / g) [s].
double gravity_time(double grain_diameter);

/// Time in which a stress moves a grain by half its diameter, d sqrt(rho / sigma) [s].
double stress_time(double grain_diameter, double grain_density, double stress);

/// Mass [kg] of a tool that moves only vertically, as on rails without friction.
sim::BodyMass on_vertical_rails(double mass);

/// A world under test. What takes steps throws Cancelled after Ctrl-C, and DeviceError when the engine raises a flag.
class TestRun {
 public:
  TestRun(std::string test, sim::SceneWorld world, const sim::StepSettings& settings, const TestPace& pace);

  void advance(Index steps) { take(steps, {}); }
  /// Advances and returns the mean contact force on a body over these steps [N].
  Vec3d mean_force(sim::BodyIndex body, Index steps) { return take(steps, {body}).front(); }
  std::vector<Vec3d> mean_forces(const std::vector<sim::BodyIndex>& bodies, Index steps) { return take(steps, bodies); }
  void set_velocity(sim::BodyIndex body, const Vec3& velocity);
  sim::BodyState body(sim::BodyIndex b);
  std::vector<sim::BodyState> bodies();
  /// Contacts of the latest step, and their impulses in the same order.
  std::vector<sim::Contact> contacts();
  std::vector<sim::Impulse> impulses();

  const sim::SceneWorld& world() const { return world_; }
  sim::Capture capture();
  double worst_residual() const { return worst_residual_; }  // largest root-mean-square residual of a step [m/s]
  /// Root-mean-square speed of the first `count` bodies [m/s].
  double rms_speed(std::size_t count);

 private:
  std::vector<Vec3d> take(Index steps, const std::vector<sim::BodyIndex>& measured);

  std::string test_;
  sim::SceneWorld world_;
  TestPace pace_;
  double step_;  // [s]
  std::unique_ptr<TestSeat> seat_;
  double worst_residual_ = 0;
};

/// World and final state of a test, for pictures.
struct TestScene {
  sim::SceneWorld world;
  sim::Capture end;
};

/// A bed at rest under its own weight: vertical stress in its contacts against the weight above, level by level.
struct GeostaticSample {
  double depth;           // below the surface [m]
  double stress, weight;  // vertical stress in contacts; weight above over area [Pa]
};

struct GeostaticResult {
  std::vector<GeostaticSample> profile;  // one per grain diameter, from the surface to the base
  double worst_error = 0;                // max of |stress / weight - 1| below the upper two grains [-]
  double solid_fraction = 0;
};

/// `grains_deep` diameters of soil on a periodic cell of ten by six.
GeostaticResult geostatic_test(const TestSoil& soil, double grains_deep, const TestPace& pace);

}  // namespace gonogo::terrain
