// The contact problem of one step of the engine, as a LocalProblem for the reference solvers.
//
//   W = B B^T,  B = J G,  M^-1 = G G^T,  q = J v_free + b
//
// J: velocities of bodies to velocities at contacts, M^-1: inverse masses, v_free: velocities at the end of the step
// without contacts, b: bias of the gaps (bias_of_gap, sim/state/world.h).
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "sim/local_problem/problem.h"
#include "sim/scene/scene.h"
#include "sim/state/contact.h"

namespace gonogo::sim {

/// What all solutions have in common, though impulses of a redundant contact network may differ. Of the freedoms that
/// contacts can change.
struct StepMotion {
  double kinetic_energy = 0;  // [J]
  Vec3d momentum;             // [N s]
};

class StepProblem {
 public:
  static constexpr std::size_t kMostWhole = 12'000'000;  // blocks of W

  /// `before`: all bodies at the start of the step. `found`: the contacts of the engine in it, bodies counted in the
  /// world. `step` [s], taken as one substep. Contacts that no body can yield to are left out. A problem whose W has
  /// more than `most_whole` blocks is not whole. Throws InputError, starting with `name`, for joints, springs, motors,
  /// force elements, cohesion, compliant contacts and spinning friction, and where no contact is left.
  StepProblem(const std::string& name, const SceneWorld& world, const std::vector<BodyState>& before,
              const std::vector<Contact>& found, double step, std::size_t most_whole = kMostWhole);

  const LocalProblem& local() const { return local_; }

  /// The engine's impulses of `found` in the frames of the contacts: normal, two tangents, moments about these.
  std::vector<double> impulses(const std::vector<Contact>& found, const std::vector<Impulse>& of_engine) const;

  /// At the end of the step under impulses r.
  StepMotion motion(const std::vector<double>& r) const;

 private:
  using Freedoms = std::array<double, BodyForm::kFreedoms>;
  /// G of a body: diagonal for translation, one column per axis of inertia for rotation.
  struct Root {
    Vec3d linear, turn[3];
  };

  /// A contact of a body, which is its first or second one.
  struct End {
    Index contact;
    int side;
  };

  void set_free_motion(const SceneWorld& world, const std::vector<BodyState>& before, double step);
  void add_contacts(const std::vector<Contact>& found);
  Freedoms scaled_row(BodyIndex body, const Vec3d& linear, const Vec3d& angular) const;
  std::vector<std::vector<End>> ends_of_bodies() const;
  std::vector<Triplet> delassus(const std::vector<std::vector<End>>& ends) const;
  std::vector<Triplet> diagonal_blocks() const;

  LocalProblem local_;
  BodyForm form_;
  std::vector<Root> root_;            // [body]
  std::vector<Vec3d> linear_, spin_;  // v_free [body]
  std::vector<Freedoms> free_;        // G^+ v_free [body]
  std::vector<std::size_t> place_;    // of each contact in `found`
};

}  // namespace gonogo::sim
