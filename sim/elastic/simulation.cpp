#include "sim/elastic/simulation.h"

#include "sim/elastic/element_matrices.h"
#include "sim/elastic/system.h"

namespace gonogo::sim::elastic {
namespace {

void set_nodes(const System& s, int body, const std::function<Vec3d(const Vec3d&)>& value, std::vector<double>& to) {
  const Mesh& mesh = s.model.body.at(std::size_t(body)).mesh;
  for (std::size_t n = 0; n < mesh.node.size(); ++n) {
    const Vec3d x = value(mesh.node[n]);
    const double component[3] = {x.x, x.y, x.z};
    for (int c = 0; c < s.dimension; ++c) to[std::size_t(s.dof(body, Index(n), c))] = component[c];
  }
}

Vec3d vector_of(const System& s, int body, Index node, const std::vector<double>& from) {
  const auto at = std::size_t(s.dof(body, node, 0));
  return {from[at], from[at + 1], s.dimension == 3 ? from[at + 2] : 0};
}

}  // namespace

Simulation::Simulation(Model model) : parts_(std::make_unique<Parts>(std::move(model))) {
  const auto dofs = std::size_t(parts_->system.dofs);
  parts_->state = {0, std::vector<double>(dofs), std::vector<double>(dofs), std::vector<double>(dofs)};
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

const Model& Simulation::model() const { return parts_->system.model; }
const State& Simulation::state() const { return parts_->state; }
int Simulation::dimension() const { return parts_->system.dimension; }
const std::vector<ContactPoint>& Simulation::contact_points() const { return parts_->points; }

void Simulation::set_velocity(int body, const std::function<Vec3d(const Vec3d&)>& velocity) {
  set_nodes(parts_->system, body, velocity, parts_->state.v);
  parts_->accelerated = false;
}

void Simulation::set_displacement(int body, const std::function<Vec3d(const Vec3d&)>& displacement) {
  set_nodes(parts_->system, body, displacement, parts_->state.u);
  parts_->accelerated = false;
}

Vec3d Simulation::displacement(int body, Index node) const {
  return vector_of(parts_->system, body, node, parts_->state.u);
}

Vec3d Simulation::velocity(int body, Index node) const {
  return vector_of(parts_->system, body, node, parts_->state.v);
}

double Simulation::mass(int body) const {
  const System& s = parts_->system;
  double sum = 0;
  for (int i = s.first[std::size_t(body)]; i < s.first[std::size_t(body) + 1]; i += s.dimension) sum += s.lumped[i];
  return sum;
}

Vec3d Simulation::mean_velocity(int body) const {
  const System& s = parts_->system;
  Vec3d sum;
  for (std::size_t n = 0; n < s.model.body[std::size_t(body)].mesh.node.size(); ++n)
    sum += vector_of(s, body, Index(n), parts_->state.v) * s.lumped[s.dof(body, Index(n), 0)];
  return sum * (1 / mass(body));
}

Vec3d Simulation::contact_force(int contact) const {
  Vec3d sum;
  for (const ContactPoint& p : parts_->points)
    if (p.contact == contact) sum += (p.normal * p.pressure + p.shear) * p.area;
  return sum;
}

Vec3d Simulation::reaction(int fixed) const {
  const System& s = parts_->system;
  const Vector u = as_vector(parts_->state.u), v = as_vector(parts_->state.v);
  Vector force = s.stiffness * s.strained(u) - s.loads(parts_->state.time), contact = Vector::Zero(s.dofs);
  s.contact.add({u, v, 0, parts_->state.time, 0}, contact, nullptr, nullptr);
  force -= contact;
  const Fixed& f = s.model.fixed.at(std::size_t(fixed));
  double sum = 0;
  for (const Index n : f.node) sum += force[s.dof(f.body, n, f.component)];
  return {f.component == 0 ? sum : 0, f.component == 1 ? sum : 0, f.component == 2 ? sum : 0};
}

Energy Simulation::energy() const {
  const System& s = parts_->system;
  const Vector u = as_vector(parts_->state.u), v = as_vector(parts_->state.v);
  Energy e;
  e.kinetic = parts_->lumped_mass ? 0.5 * v.dot(s.lumped.cwiseProduct(v)) : 0.5 * v.dot(s.mass * v);
  const Vector strained = s.strained(u);
  e.strain = 0.5 * strained.dot(s.stiffness * strained);
  e.compliance = parts_->compliance_energy;
  e.load = -s.loads(parts_->state.time).dot(u);
  return e;
}

std::vector<std::array<double, 6>> Simulation::node_stress(int body) const {
  const System& s = parts_->system;
  const Body& b = s.model.body.at(std::size_t(body));
  const int corners = corner_count(b.mesh.kind);
  const Matrix6 d = elasticity(b.material, s.dimension == 2 && b.plane == Plane::stress);
  std::vector<std::array<double, 6>> stress(b.mesh.node.size());
  std::vector<double> volume(b.mesh.node.size());
  for (std::size_t e = 0; e < b.mesh.element.size(); ++e) {
    Vector u(corners * s.dimension);
    for (int i = 0; i < u.size(); ++i)
      u[i] =
          parts_->state.u[std::size_t(s.dof(body, b.mesh.element[e][std::size_t(i / s.dimension)], i % s.dimension))];
    for (const QuadraturePoint& q : quadrature_of(b.mesh.kind)) {
      const ShapeValues n = shape_values(b.mesh.kind, q.at);
      const Gradient g = gradient_of(b.mesh, e, n);
      const PointVolume v = volume_at(b, e, q, n, g);
      Eigen::Matrix<double, 6, 1> sigma = d * (strain_matrix(corners, s.dimension, g, n, v.radius) * u);
      for (int k = 0; k < corners; ++k) {
        const auto node = std::size_t(b.mesh.element[e][std::size_t(k)]);
        volume[node] += v.volume;
        for (std::size_t i = 0; i < 6; ++i) stress[node][i] += v.volume * sigma[long(i)];
      }
    }
  }
  for (std::size_t n = 0; n < stress.size(); ++n)
    for (double& x : stress[n]) x /= volume[n];
  return stress;
}

}  // namespace gonogo::sim::elastic
