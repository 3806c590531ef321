// Matrices and forces of a model, and one implicit step of it. Internal: Eigen.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cmath>

#include "sim/elastic/contact.h"
#include "sim/elastic/mesh.h"
#include "sim/elastic/model.h"
#include "sim/elastic/simulation.h"

namespace gonogo::sim::elastic {

using ElementMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 24, 24>;
using StrainMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 24>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Stress from strain, both as xx, yy, zz, xy, yz, zx with engineering shear; Hughes, section 2.7. Plane stress: zz is
/// 0.
Matrix6 elasticity(const Material& material, bool plane_stress);
/// Strain from the corners' displacements. `radius` above 0: hoop strain u_x / radius.
StrainMatrix strain_matrix(int corners, int dimension, const Gradient& gradient, const ShapeValues& values,
                           double radius);
/// Volume that belongs to a quadrature point [m^3], and its radius where the body is axisymmetric, else 0.
struct PointVolume {
  double volume = 0, radius = 0;
};
PointVolume volume_at(const Body& body, std::size_t element, const QuadraturePoint& q, const ShapeValues& values,
                      const Gradient& gradient);

ElementMatrix stiffness_of(const Body& body, std::size_t element);        // [N/m]
ElementMatrix consistent_mass_of(const Body& body, std::size_t element);  // [kg]
/// Row sums of the consistent mass, one per corner [kg].
Eigen::VectorXd lumped_mass_of(const Body& body, std::size_t element);

/// Largest eigenvalue, by power iteration, of M^-1 A with lumped mass [dof]; A symmetric, at least positive
/// semidefinite.
inline double largest_eigenvalue(const Eigen::SparseMatrix<double>& a, const Eigen::VectorXd& mass) {
  Eigen::VectorXd x(mass.size());
  for (long i = 0; i < x.size(); ++i) x[i] = std::sin(1 + 12.9898 * double(i));  // no mode is orthogonal to it
  double value = 0;
  for (int k = 0; k < 5000; ++k) {
    x /= std::sqrt(x.dot(mass.cwiseProduct(x)));
    const Eigen::VectorXd y = (a * x).cwiseQuotient(mass);
    const double next = x.dot(mass.cwiseProduct(y));
    const bool settled = std::fabs(next - value) <= 1e-9 * next;
    value = next;
    if (!(value > 0) || (settled && k > 20)) break;
    x = y;
  }
  return value;
}

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

// One implicit step: its equations, and their solution by Newton-Raphson with a line search.

/// Unknown: displacements u at the end of the step. Velocity v = rate u + v_rest and acceleration a = inertia u +
/// a_rest are linear in it. Equations on free degrees of freedom, with g(u, v) = loads - K u + contact:
///   (1 + alpha) g(u, v) - alpha g_before - M a = 0
struct ImplicitStep {
  const System& system;
  double time = 0, step = 0;  // at the end; length [s]
  double rate = 0, inertia = 0, alpha = 0;
  Vector v_rest{}, a_rest{}, g_before{};  // [dof]; a_rest counts where inertia is above 0

  Vector velocity(const Vector& u) const { return rate * u + v_rest; }
  Vector acceleration(const Vector& u) const { return inertia * u + a_rest; }
};

/// g(u, v) and what it is made of.
struct Forces {
  Vector g;          // [dof] [N]
  double scale = 0;  // norm of the largest part [N]
  double compliance_energy = 0;
};
Forces forces_at(const System& system, const Vector& u, const Vector& v, double rate, double time, double step,
                 Triplets* tangent, std::vector<ContactPoint>* points);

struct NewtonResult {
  bool converged = false;
  std::string reason;
  Vector u;
  std::vector<ContactPoint> points;
  double compliance_energy = 0;
};

/// `u`: first guess with the fixed displacements of the step's end. Fills the report's iterations, halvings, residuals.
NewtonResult solve_step(const ImplicitStep& step, Vector u, const NewtonSettings& settings, StepReport& report);

}  // namespace gonogo::sim::elastic
