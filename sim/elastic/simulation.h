// Elastic bodies in contact: statics by load increments, dynamics by Newmark's method and central differences.
// Public; free of Eigen. Same model, same bits: nothing here runs in parallel.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/elastic/model.h"

namespace gonogo::sim::elastic {

/// Degree of freedom k of node n of a body: first of the body + n * dimension + k.
struct State {
  double time = 0;              // [s]
  std::vector<double> u, v, a;  // [dof]: [m], [m/s], [m/s^2]
};

struct NewtonSettings {
  int max_iterations = 25;
  double tolerance = 1e-9;  // of the residual over the largest of all forces, Euclidean norms
  bool line_search = true;  // halve the correction while the residual does not fall
};

/// Newmark 1959; dissipative with alpha in [-1/3, 0): Hilber, Hughes & Taylor 1977, where forces are weighted
/// (1 + alpha) at the end and -alpha at the start of a step.
struct NewmarkSettings {
  double beta = 0.25, gamma = 0.5, alpha = 0;
};
/// beta = (1 - alpha)^2 / 4, gamma = 1/2 - alpha. Throws InputError for alpha outside -1/3 to 0.
NewmarkSettings hht(double alpha);

class Simulation;

struct MarchSettings {
  double end = 1;         // [s], also of statics, where friction feels the speed
  double step = 0.1;      // longest step [s]
  double min_step = 0;    // shortest [s]; 0: a 4096th of `step`
  double stick_step = 0;  // longest step in which a point may go from slip to stick or turn around [s]; 0: any
  NewtonSettings newton{};
  NewmarkSettings newmark{};
  std::function<bool(const Simulation&)> watch{};  // called after every step; false ends the run
};

/// One step tried.
struct StepReport {
  double time = 0, step = 0;  // at its end [s]
  bool accepted = false;
  int iterations = 0, halvings = 0;   // of Newton; of corrections by the line search
  std::vector<double> residual{};     // relative, before each correction and after the last
  int open = 0, stick = 0, slip = 0;  // Gauss points at its end
};

struct MarchReport {
  bool finished = false;
  std::string reason;  // why it ended before `end`, for people
  std::vector<StepReport> step;
  int newton_failures = 0, stick_halvings = 0;
  long iterations() const;
};

/// Largest stable steps of central differences [s].
struct CriticalStep {
  double by_iteration = 0;  // 2 / omega_max: power iteration on M^-1 K with lumped mass and touching contacts
  double by_wave = 0;       // smallest L / c: a wave crosses no element in one step; c of dilatation
  double by_friction = 0;   // 2 over the largest rate at which regularised friction brakes a node; infinite without
};

struct CentralSettings {
  double end = 1, step = 0;           // [s]
  bool refuse_above_critical = true;  // false: for studies of the bound itself
  std::function<bool(const Simulation&)> watch{};
};

struct Energy {
  double kinetic = 0, strain = 0, compliance = 0, load = 0;  // [J]; load: -f u of gravity and tractions
  double total() const { return kinetic + strain + compliance + load; }
};

class Simulation {
 public:
  /// Throws InputError as check_model does.
  explicit Simulation(Model model);
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  const Model& model() const;
  const State& state() const;
  int dimension() const;

  /// Initial state. Accelerations follow from the forces when dynamics begin.
  void set_velocity(int body, const std::function<Vec3d(const Vec3d& node)>& velocity);
  void set_displacement(int body, const std::function<Vec3d(const Vec3d& node)>& displacement);

  /// Load increments until `end`. Newmark's numbers do not count. Throws InputError as check_held does and for steps
  /// not above 0. Failing to converge is a result.
  MarchReport statics(const MarchSettings& settings);
  /// Throws InputError for a body without density, beta or gamma that make the method unstable.
  MarchReport newmark(const MarchSettings& settings);

  CriticalStep critical_step() const;
  /// Throws InputError for a body without density and for a step above the critical one. Where contact stiffens on the
  /// way the bound is computed again; the run ends with a reason when the step is above it.
  MarchReport central_difference(const CentralSettings& settings);

  Vec3d displacement(int body, Index node) const;
  Vec3d velocity(int body, Index node) const;
  Vec3d mean_velocity(int body) const;  // of the centre of mass
  double mass(int body) const;          // [kg]
  /// Gauss points at the end of the last step.
  const std::vector<ContactPoint>& contact_points() const;
  Vec3d contact_force(int contact) const;  // on `body` [N]
  Energy energy() const;                   // with the mass matrix of the last integrator: consistent, or lumped
  /// xx, yy, zz, xy, yz, zx [Pa] per node, mean of its elements weighted by volume.
  std::vector<std::array<double, 6>> node_stress(int body) const;

  struct Parts;

 private:
  std::unique_ptr<Parts> parts_;
};

}  // namespace gonogo::sim::elastic
