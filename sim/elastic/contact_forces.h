// Contact forces and their consistent tangent. Internal: Eigen.
#pragma once
#include <Eigen/Sparse>
#include <array>
#include <vector>

#include "sim/elastic/contact_point.h"
#include "sim/elastic/model.h"

namespace gonogo::sim::elastic {

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Where and how fast everything is. Friction acts on v; v changes by `rate` [1/s] times the change of u.
struct Motion {
  const Vector& u;  // [dof]
  const Vector& v;  // [dof]
  double rate = 0;
  double time = 0, step = 0;  // rigid shapes move from time - step to time
};

class ContactForces {
 public:
  /// `first` degree of freedom of each body. Keeps a reference to the model.
  ContactForces(const Model& model, std::vector<int> first);

  /// Adds the forces on the bodies [N], and to `tangent` minus their derivative by u. `points`, if given, becomes the
  /// state of every Gauss point. Returns the energy stored in the normal compliance [J].
  double add(const Motion& motion, Vector& force, Triplets* tangent, std::vector<ContactPoint>* points) const;
  bool has_friction() const;
  bool empty() const { return place_.empty(); }

 private:
  struct Place {  // a Gauss point
    int contact = 0;
    std::size_t face = 0;
    std::array<double, 4> n{};
    double area = 0;
  };
  struct Side {  // a face of the other body, displaced
    std::array<Vec3d, 4> corner{};
    Vec3d centre{};
    double radius = 0;
  };
  using Sides = std::vector<std::vector<Side>>;  // [contact][other_face]

  void prepare(int contact);
  Sides sides_of(const Vector& u) const;
  int nearest_face(const Place& p, const Vec3d& x, const std::vector<Side>& sides) const;
  double at_place(const Place& p, const Motion& motion, const Sides& sides, Vector& force, Triplets* tangent,
                  ContactPoint& state) const;
  template <int N>
  double with_slopes(const Place& p, int other_face, const Motion& motion, Vector& force, Triplets* tangent,
                     ContactPoint& state) const;

  const Model& model_;
  std::vector<int> first_;
  int dimension_;
  std::vector<Place> place_;
  std::vector<std::vector<std::array<bool, 2>>> goes_on_;  // [contact][other_face]: ends of edges shared with others
  std::vector<double> reach_;                              // [contact]
};

}  // namespace gonogo::sim::elastic
