#include "sim/elastic/simulation.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "sim/elastic/mesh.h"
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

// Load increments and Newmark's method, with steps that shrink where Newton fails and where slip turns to stick.

namespace {

using Parts = Simulation::Parts;
/// The step from the present state, and a first guess of its end.
using Prepare = std::function<std::pair<ImplicitStep, Vector>(double step)>;

void check_settings(const MarchSettings& s) {
  if (!(s.step > 0)) throw InputError(line("step is %g s; it must be above 0", s.step));
  if (!(s.min_step >= 0 && s.min_step <= s.step))
    throw InputError(line("shortest step is %g s; allowed is 0 to the step, %g", s.min_step, s.step));
  if (s.newton.max_iterations < 1 || !(s.newton.tolerance > 0))
    throw InputError(line("Newton's method: %d iterations to %g; both must be above 0", s.newton.max_iterations,
                          s.newton.tolerance));
}

void check_newmark(const NewmarkSettings& n) {
  if (n.alpha == 0 && !(n.gamma >= 0.5 && n.beta >= n.gamma / 2))
    throw InputError(
        line("Newmark's beta %g and gamma %g: stable at any step are gamma of at least 1/2 and beta of at "
             "least gamma / 2; 0.25 and 0.5 conserve energy",
             n.beta, n.gamma));
  if (!(n.alpha >= -1.0 / 3 && n.alpha <= 0)) throw InputError(line("alpha is %g; allowed is -1/3 to 0", n.alpha));
}

bool turns(const ContactPoint& before, const ContactPoint& now) {
  if (before.touch != Touch::slip) return false;
  return now.touch == Touch::stick || (now.touch == Touch::slip && dot(before.sliding, now.sliding) < 0);
}

bool any_turns(const std::vector<ContactPoint>& before, const std::vector<ContactPoint>& now) {
  for (std::size_t i = 0; i < std::min(before.size(), now.size()); ++i)
    if (turns(before[i], now[i])) return true;
  return false;
}

void count_touches(const std::vector<ContactPoint>& points, StepReport& report) {
  for (const ContactPoint& p : points)
    ++(p.touch == Touch::open ? report.open : p.touch == Touch::stick ? report.stick : report.slip);
}

void accept(Parts& p, const ImplicitStep& step, NewtonResult&& found) {
  p.state.time = step.time;
  assign(p.state.v, step.velocity(found.u));
  if (step.inertia > 0) assign(p.state.a, step.acceleration(found.u));
  assign(p.state.u, found.u);
  p.points = std::move(found.points);
  p.compliance_energy = found.compliance_energy;
}

MarchReport march(Simulation& simulation, Parts& p, const MarchSettings& s, const Prepare& prepare) {
  MarchReport report;
  const double shortest = s.min_step > 0 ? s.min_step : s.step / 4096;
  double h = s.step;
  while (s.end - p.state.time > 1e-9 * s.step) {
    h = std::min(h, s.end - p.state.time);
    auto [step, guess] = prepare(h);
    StepReport one{.time = step.time, .step = h};
    NewtonResult found = solve_step(step, std::move(guess), s.newton, one);
    count_touches(found.points, one);
    const bool too_long = found.converged && s.stick_step > 0 && h > s.stick_step && any_turns(p.points, found.points);
    one.accepted = found.converged && !too_long;
    report.step.push_back(one);
    if (!one.accepted) {
      ++(found.converged ? report.stick_halvings : report.newton_failures);
      h = too_long ? std::max(h / 2, s.stick_step) : h / 2;
      if (h >= shortest) continue;
      report.reason = line("at %.6g s, with a step of %.3g s: ", p.state.time, 2 * h) + found.reason;
      return report;
    }
    accept(p, step, std::move(found));
    if (s.watch && !s.watch(simulation)) {
      report.reason = "ended by the watch";
      return report;
    }
    h = std::min(s.step, 2 * h);
  }
  report.finished = true;
  return report;
}

/// From M a = g; the fixed ones rest.
void start_acceleration(Parts& p) {
  const System& s = p.system;
  const Vector u = as_vector(p.state.u), v = as_vector(p.state.v);
  const Forces f = forces_at(s, u, v, 0, p.state.time, 0, nullptr, &p.points);
  const Eigen::SimplicialLDLT<Sparse> ldlt(s.free_mass);
  const Vector a = ldlt.solve(s.freed(f.g));
  for (int i = 0; i < s.dofs; ++i)
    p.state.a[std::size_t(i)] = s.free[std::size_t(i)] < 0 ? 0 : a[s.free[std::size_t(i)]];
  p.accelerated = true;
}

ImplicitStep newmark_step(const Parts& p, const NewmarkSettings& n, double h, Vector& guess) {
  const Vector u = as_vector(p.state.u), v = as_vector(p.state.v), a = as_vector(p.state.a);
  ImplicitStep step{p.system, p.state.time + h, h};
  step.inertia = 1 / (n.beta * h * h);
  step.rate = n.gamma / (n.beta * h);
  step.alpha = n.alpha;
  const Vector predicted = u + h * v + h * h * (0.5 - n.beta) * a;
  step.a_rest = -step.inertia * predicted;
  step.v_rest = v + h * (1 - n.gamma) * a - step.rate * predicted;
  if (n.alpha != 0) step.g_before = forces_at(p.system, u, v, 0, p.state.time, h, nullptr, nullptr).g;
  guess = u + h * v + 0.5 * h * h * a;
  p.system.fix(step.time, guess);
  return step;
}

}  // namespace

NewmarkSettings hht(double alpha) {
  if (!(alpha >= -1.0 / 3 && alpha <= 0)) throw InputError(line("alpha is %g; allowed is -1/3 to 0", alpha));
  return {(1 - alpha) * (1 - alpha) / 4, 0.5 - alpha, alpha};
}

long MarchReport::iterations() const {
  long sum = 0;
  for (const StepReport& s : step) sum += s.iterations;
  return sum;
}

MarchReport Simulation::statics(const MarchSettings& settings) {
  check_settings(settings);
  check_held(model());
  Parts& p = *parts_;
  p.accelerated = false;
  return march(*this, p, settings, [&p](double h) {
    ImplicitStep step{p.system, p.state.time + h, h};
    Vector u = as_vector(p.state.u);
    step.rate = 1 / h;
    step.v_rest = -u / h;
    p.system.fix(step.time, u);
    return std::pair{std::move(step), std::move(u)};
  });
}

MarchReport Simulation::newmark(const MarchSettings& settings) {
  check_settings(settings);
  check_newmark(settings.newmark);
  Parts& p = *parts_;
  p.system.need_density();
  p.lumped_mass = false;
  if (!p.accelerated) start_acceleration(p);
  return march(*this, p, settings, [&p, &settings](double h) {
    Vector guess;
    ImplicitStep step = newmark_step(p, settings.newmark, h, guess);
    return std::pair{std::move(step), std::move(guess)};
  });
}

// Central differences with lumped mass, and the largest step at which they are stable.

namespace {

/// Least height of an element: its volume over its widest face, times 2 or 3 for triangles and tetrahedra [m].
double height_of(const Mesh& mesh, std::size_t e) {
  double volume = 0, widest = 0;
  for (const QuadraturePoint& q : quadrature_of(mesh.kind))
    volume += q.weight * gradient_of(mesh, e, shape_values(mesh.kind, q.at)).determinant;
  Mesh alone{mesh.kind, mesh.node, {mesh.element[e]}};
  for (const Face& f : boundary_faces(alone)) {
    std::array<Vec3d, 4> x{};
    for (int k = 0; k < f.count; ++k) x[k] = mesh.node[std::size_t(f.node[k])];
    double size = 0;
    for (const FacePoint& p : face_quadrature(f.count, 2)) size += p.weight * face_measure(f.count, p, x);
    widest = std::max(widest, size);
  }
  const double simplex = mesh.kind == ElementKind::t3 ? 2 : mesh.kind == ElementKind::t4 ? 3 : 1;
  return simplex * volume / widest;
}

double wave_step(const Model& model) {
  double least = std::numeric_limits<double>::infinity();
  for (const Body& b : model.body) {
    const Material& m = b.material;
    const bool stress = dimension_of(b.mesh.kind) == 2 && b.plane == Plane::stress;
    const double modulus = stress ? m.young / (1 - m.poisson * m.poisson)
                                  : m.young * (1 - m.poisson) / ((1 + m.poisson) * (1 - 2 * m.poisson));
    const double speed = std::sqrt(modulus / m.density);
    for (std::size_t e = 0; e < b.mesh.element.size(); ++e) least = std::min(least, height_of(b.mesh, e) / speed);
  }
  return least;
}

double deepest(const std::vector<ContactPoint>& points) {
  double depth = 0;
  for (const ContactPoint& p : points) depth = std::max(depth, -p.gap);
  return depth;
}

void central_step(Parts& p, double h) {
  const System& s = p.system;
  Vector u = as_vector(p.state.u), a = as_vector(p.state.a);
  Vector half = as_vector(p.state.v) + 0.5 * h * a;
  const Vector before = u;
  u += h * half;
  p.state.time += h;
  s.fix(p.state.time, u);
  for (int i = 0; i < s.dofs; ++i)
    if (s.free[std::size_t(i)] < 0) half[i] = (u[i] - before[i]) / h;
  const Forces f = forces_at(s, u, half, 0, p.state.time, h, nullptr, &p.points);
  p.compliance_energy = f.compliance_energy;
  Vector v = half;
  for (int i = 0; i < s.dofs; ++i) {
    a[i] = s.free[std::size_t(i)] < 0 ? 0 : f.g[i] / s.lumped[i];
    v[i] += 0.5 * h * a[i];
  }
  assign(p.state.u, u);
  assign(p.state.v, v);
  assign(p.state.a, a);
}

void start(Parts& p) {
  const System& s = p.system;
  const Forces f = forces_at(s, as_vector(p.state.u), as_vector(p.state.v), 0, p.state.time, 0, nullptr, &p.points);
  for (int i = 0; i < s.dofs; ++i) p.state.a[std::size_t(i)] = s.free[std::size_t(i)] < 0 ? 0 : f.g[i] / s.lumped[i];
  p.lumped_mass = true;
  p.accelerated = false;  // of the lumped mass: Newmark's method starts anew
}

double bound_of(const CriticalStep& c) { return std::min(c.by_iteration, c.by_friction); }

}  // namespace

CriticalStep Simulation::critical_step() const {
  const System& s = parts_->system;
  s.need_density();
  const Vector u = as_vector(parts_->state.u), v = as_vector(parts_->state.v), mass = s.freed(s.lumped);
  Vector none = Vector::Zero(s.dofs);
  const auto tangent = [&](double rate) {
    Triplets t;
    s.contact.add({u, v, rate, parts_->state.time, 0}, none, &t, nullptr);
    return s.freed(t);
  };
  const Sparse stiff = tangent(0), braked = tangent(1);
  CriticalStep c;
  c.by_wave = wave_step(s.model);
  c.by_iteration = 2 / std::sqrt(largest_eigenvalue(s.free_stiffness + stiff, mass));
  c.by_friction = std::numeric_limits<double>::infinity();
  const Sparse brake = braked - stiff;
  if (brake.norm() > 0) c.by_friction = 2 / largest_eigenvalue(brake, mass);
  return c;
}

MarchReport Simulation::central_difference(const CentralSettings& settings) {
  Parts& p = *parts_;
  p.system.need_density();
  if (!(settings.step > 0)) throw InputError(line("step is %g s; it must be above 0", settings.step));
  const CriticalStep first = critical_step();
  if (settings.refuse_above_critical && settings.step > bound_of(first))
    throw InputError(
        line("step is %.4g s, above the critical one of central differences, %.4g s (elements %.4g s, "
             "friction %.4g s); take a shorter step or Newmark's method",
             settings.step, bound_of(first), first.by_iteration, first.by_friction));
  start(p);
  MarchReport report;
  double checked_depth = deepest(p.points);
  while (settings.end - p.state.time > 1e-9 * settings.step) {
    const double h = std::min(settings.step, settings.end - p.state.time);
    central_step(p, h);
    StepReport one{.time = p.state.time, .step = h, .accepted = true};
    for (const ContactPoint& q : p.points)
      ++(q.touch == Touch::open ? one.open : q.touch == Touch::stick ? one.stick : one.slip);
    report.step.push_back(one);
    if (settings.watch && !settings.watch(*this)) {
      report.reason = "ended by the watch";
      return report;
    }
    if (!settings.refuse_above_critical || deepest(p.points) <= 1.2 * checked_depth) continue;
    checked_depth = deepest(p.points);
    const double bound = bound_of(critical_step());
    if (settings.step <= bound) continue;
    report.reason = line("at %.6g s contact stiffened, and the step of %.4g s is above the critical one, %.4g s",
                         p.state.time, settings.step, bound);
    return report;
  }
  report.finished = true;
  return report;
}

}  // namespace gonogo::sim::elastic
