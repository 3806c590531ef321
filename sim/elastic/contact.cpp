#include "sim/elastic/contact.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>

#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {
namespace {

Vec3d vector_at(const Vector& u, int at, int dimension) { return {u[at], u[at + 1], dimension == 3 ? u[at + 2] : 0.0}; }

/// Degrees of freedom of the corners of one or two faces.
struct LocalDofs {
  std::array<int, 8> first{};  // of each corner
  int own = 0, all = 0;        // corners of the own face; of both
};

/// Places and velocities of the corners, as functions of the displacements.
template <int N>
struct LocalMotion {
  std::array<Vec3T<Dual<N>>, 8> place, velocity;
};

template <int N>
LocalMotion<N> local_motion(const LocalDofs& dofs, const std::array<Vec3d, 8>& node, const Motion& m, int dimension) {
  LocalMotion<N> local;
  for (int k = 0; k < dofs.all; ++k) {
    Dual<N> x[3] = {node[k].x, node[k].y, node[k].z}, v[3];
    for (int c = 0; c < dimension; ++c) {
      const int at = dofs.first[k] + c, variable = k * dimension + c;
      x[c] += Dual<N>::variable(m.u[at], variable);
      v[c] = Dual<N>(m.v[at]);
      v[c].slope[std::size_t(variable)] = m.rate;
    }
    local.place[k] = {x[0], x[1], x[2]};
    local.velocity[k] = {v[0], v[1], v[2]};
  }
  return local;
}

template <int N>
void scatter(const LocalDofs& dofs, int corner, const Vec3T<Dual<N>>& f, int dimension, Vector& force,
             Triplets* tangent) {
  const Dual<N> component[3] = {f.x, f.y, f.z};
  for (int c = 0; c < dimension; ++c) {
    const int row = dofs.first[corner] + c;
    force[row] += component[c].value;
    if (tangent == nullptr) continue;
    for (int k = 0; k < dofs.all; ++k)
      for (int e = 0; e < dimension; ++e) {
        const int variable = k * dimension + e;
        tangent->emplace_back(row, dofs.first[k] + e, -component[c].slope[std::size_t(variable)]);
      }
  }
}

}  // namespace

ContactForces::ContactForces(const Model& model, std::vector<int> first)
    : model_(model),
      first_(std::move(first)),
      dimension_(dimension_of(model.body[0].mesh.kind)),
      goes_on_(model.contact.size()),
      reach_(model.contact.size(), 0) {
  for (std::size_t c = 0; c < model.contact.size(); ++c) prepare(int(c));
}

void ContactForces::prepare(int contact) {
  const Contact& c = model_.contact[std::size_t(contact)];
  const Body& body = model_.body[std::size_t(c.body)];
  for (std::size_t f = 0; f < c.face.size(); ++f) {
    const Face& face = c.face[f];
    std::array<Vec3d, 4> x{};
    for (int k = 0; k < face.count; ++k) x[k] = body.mesh.node[std::size_t(face.node[k])];
    for (const FacePoint& q : face_quadrature(face.count, c.points)) {
      Place p{contact, f, q.n, q.weight * face_measure(face.count, q, x)};
      double radius = 0;
      for (int k = 0; k < face.count; ++k) radius += q.n[k] * x[k].x;
      if (dimension_ == 2) p.area *= body.plane == Plane::axisymmetric ? 2 * std::numbers::pi * radius : body.thickness;
      place_.push_back(p);
    }
  }
  std::map<Index, int> times;
  for (const Face& f : c.other_face)
    for (int k = 0; k < f.count; ++k) ++times[f.node[k]];
  for (const Face& f : c.other_face) {
    goes_on_[std::size_t(contact)].push_back({times[f.node[0]] > 1, times[f.node[1]] > 1});
    const auto& node = model_.body[std::size_t(c.other)].mesh.node;
    for (int k = 1; k < f.count && c.reach == 0; ++k)
      reach_[std::size_t(contact)] =
          std::max(reach_[std::size_t(contact)], length(node[std::size_t(f.node[k])] - node[std::size_t(f.node[0])]));
  }
  if (c.reach > 0) reach_[std::size_t(contact)] = c.reach;
}

bool ContactForces::has_friction() const {
  return std::any_of(model_.contact.begin(), model_.contact.end(), [](const Contact& c) { return c.law.c_t > 0; });
}

ContactForces::Sides ContactForces::sides_of(const Vector& u) const {
  Sides sides(model_.contact.size());
  for (std::size_t c = 0; c < model_.contact.size(); ++c) {
    const Contact& contact = model_.contact[c];
    for (const Face& f : contact.other_face) {
      Side s;
      for (int k = 0; k < f.count; ++k) {
        const Index n = f.node[k];
        s.corner[k] = model_.body[std::size_t(contact.other)].mesh.node[std::size_t(n)] +
                      vector_at(u, first_[std::size_t(contact.other)] + n * dimension_, dimension_);
        s.centre += s.corner[k] * (1.0 / f.count);
      }
      for (int k = 0; k < f.count; ++k) s.radius = std::max(s.radius, length(s.corner[k] - s.centre));
      sides[c].push_back(s);
    }
  }
  return sides;
}

int ContactForces::nearest_face(const Place& p, const Vec3d& x, const std::vector<Side>& sides) const {
  const auto contact = std::size_t(p.contact);
  const double reach = reach_[contact];
  double least = std::numeric_limits<double>::infinity();
  int nearest = -1;
  for (std::size_t f = 0; f < sides.size(); ++f) {
    const Side& s = sides[f];
    if (length(x - s.centre) > s.radius + reach) continue;
    const auto found = project(x, s.corner, model_.contact[contact].other_face[f].count, goes_on_[contact][f]);
    if (!found || found->distance >= least || found->gap.gap < -reach) continue;
    least = found->distance;
    nearest = int(f);
  }
  return nearest;
}

template <int N>
double ContactForces::with_slopes(const Place& p, int other_face, const Motion& motion, Vector& force,
                                  Triplets* tangent, ContactPoint& state) const {
  const Contact& c = model_.contact[std::size_t(p.contact)];
  LocalDofs dofs;
  std::array<Vec3d, 8> node{};
  const auto take = [&](int body, const Face& f) {
    for (int k = 0; k < f.count; ++k, ++dofs.all) {
      node[dofs.all] = model_.body[std::size_t(body)].mesh.node[std::size_t(f.node[k])];
      dofs.first[dofs.all] = first_[std::size_t(body)] + f.node[k] * dimension_;
    }
  };
  take(c.body, c.face[p.face]);
  dofs.own = dofs.all;
  if (other_face >= 0) take(c.other, c.other_face[std::size_t(other_face)]);
  const LocalMotion<N> local = local_motion<N>(dofs, node, motion, dimension_);
  using D = Dual<N>;
  Vec3T<D> x, v;
  for (int k = 0; k < dofs.own; ++k) {
    x += local.place[k] * D(p.n[k]);
    v += local.velocity[k] * D(p.n[k]);
  }
  Projection<D> on;
  if (other_face >= 0) {
    std::array<Vec3T<D>, 4> corner{};
    for (int k = dofs.own; k < dofs.all; ++k) corner[k - dofs.own] = local.place[k];
    on = *project(x, corner, dofs.all - dofs.own, goes_on_[std::size_t(p.contact)][std::size_t(other_face)]);
    for (int k = dofs.own; k < dofs.all; ++k) v -= local.velocity[k] * on.weight[k - dofs.own];
  } else {
    const Vec3d by = c.shape.displacement(motion.time);
    on.gap = gap_above(c.shape, by, x);
    if (motion.step > 0) v -= constant<D>((by - c.shape.displacement(motion.time - motion.step)) * (1 / motion.step));
  }
  const Traction3<N> t = traction_of<N>(c.law, on.gap, v);
  const Vec3T<D> pull = (on.gap.normal * t.pressure + t.shear) * D(p.area);
  for (int k = 0; k < dofs.own; ++k) scatter<N>(dofs, k, pull * D(p.n[k]), dimension_, force, tangent);
  for (int k = dofs.own; k < dofs.all; ++k)
    scatter<N>(dofs, k, pull * (-on.weight[k - dofs.own]), dimension_, force, tangent);
  state.normal = value_of(on.gap.normal);
  state.pressure = t.pressure.value;
  state.shear = value_of(t.shear);
  state.sliding = value_of(t.sliding);
  state.touch = length(state.sliding) < c.law.epsilon ? Touch::stick : Touch::slip;
  return t.pressure.value * -on.gap.gap.value / (c.law.m_n + 1) * p.area;
}

double ContactForces::at_place(const Place& p, const Motion& m, const Sides& sides, Vector& force, Triplets* tangent,
                               ContactPoint& state) const {
  const Contact& c = model_.contact[std::size_t(p.contact)];
  const Body& body = model_.body[std::size_t(c.body)];
  const Face& face = c.face[p.face];
  Vec3d x;
  for (int k = 0; k < face.count; ++k)
    x += (body.mesh.node[std::size_t(face.node[k])] +
          vector_at(m.u, first_[std::size_t(c.body)] + face.node[k] * dimension_, dimension_)) *
         p.n[k];
  state = {.contact = p.contact, .place = x, .gap = std::numeric_limits<double>::infinity(), .area = p.area};
  int other_face = -1;
  if (c.other >= 0) {
    const auto& all = sides[std::size_t(p.contact)];
    other_face = nearest_face(p, x, all);
    if (other_face < 0) return 0;
    const auto f = std::size_t(other_face);
    state.gap = project(x, all[f].corner, c.other_face[f].count, goes_on_[std::size_t(p.contact)][f])->gap.gap;
  } else {
    state.gap = gap_above(c.shape, c.shape.displacement(m.time), x).gap;
  }
  if (!(state.gap < 0)) return 0;
  if (dimension_ == 2)
    return other_face < 0 ? with_slopes<4>(p, other_face, m, force, tangent, state)
                          : with_slopes<8>(p, other_face, m, force, tangent, state);
  return other_face < 0 ? with_slopes<12>(p, other_face, m, force, tangent, state)
                        : with_slopes<24>(p, other_face, m, force, tangent, state);
}

double ContactForces::add(const Motion& motion, Vector& force, Triplets* tangent,
                          std::vector<ContactPoint>* points) const {
  const Sides sides = sides_of(motion.u);
  if (points != nullptr) points->resize(place_.size());
  double energy = 0;
  for (std::size_t i = 0; i < place_.size(); ++i) {
    ContactPoint state;
    energy += at_place(place_[i], motion, sides, force, tangent, state);
    if (points != nullptr) (*points)[i] = state;
  }
  return energy;
}

}  // namespace gonogo::sim::elastic
