// Matrices and forces of a model. Internal: Eigen.
#pragma once
#include "sim/elastic/contact_forces.h"
#include "sim/elastic/simulation.h"

namespace gonogo::sim::elastic {

using Sparse = Eigen::SparseMatrix<double>;

struct System {
  explicit System(Model given);

  Model model;
  int dimension;
  std::vector<int> first;  // degree of freedom of each body; one more at the end
  int dofs = 0, free_count = 0;
  std::vector<int> free;   // [dof] place among those that move freely; -1: fixed
  Sparse stiffness, mass;  // of all degrees of freedom [N/m], [kg]
  Sparse free_stiffness, free_mass;
  Vector lumped;        // [dof] [kg]
  double stiffest = 0;  // largest diagonal entry of the stiffness [N/m]
  ContactForces contact;

  int dof(int body, Index node, int component) const { return first[std::size_t(body)] + node * dimension + component; }
  Vector loads(double time) const;  // gravity and tractions [N]
  /// Displacements less the mean of each body where it may move so without strain: K u of a body that slid far stays
  /// exact.
  Vector strained(const Vector& u) const;
  /// Sets fixed displacements of a time.
  void fix(double time, Vector& u) const;
  Vector freed(const Vector& all) const;
  Sparse freed(const Sparse& all) const;
  Sparse freed(const Triplets& all) const;
  /// Throws InputError, naming the body, where one has no density.
  void need_density() const;
};

inline Vector as_vector(const std::vector<double>& x) { return Eigen::Map<const Vector>(x.data(), long(x.size())); }
inline void assign(std::vector<double>& to, const Vector& from) { to.assign(from.data(), from.data() + from.size()); }

struct Simulation::Parts {
  explicit Parts(Model given) : system(std::move(given)) {}
  System system;
  State state;
  std::vector<ContactPoint> points;
  double compliance_energy = 0;
  bool accelerated = false;  // state.a belongs to the state
  bool lumped_mass = false;
};

}  // namespace gonogo::sim::elastic
