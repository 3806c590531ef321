#include "sim/local_problem/step_problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/simulation/step.h"

namespace gonogo::sim {
namespace {

constexpr int kFreedoms = BodyForm::kFreedoms;

void refuse(const std::string& name, bool present, const std::string& what) {
  if (present) throw InputError(name + ": a step problem has no " + what + "; take a scene without");
}

void check(const std::string& name, const SceneWorld& world, const std::vector<Contact>& found) {
  refuse(name, !world.joint.empty() || !world.spring.empty(), "joints and springs");
  refuse(name, !world.motor.empty() || !world.force.empty(), "motors and force elements");
  const auto any = [&](auto holds) { return std::any_of(found.begin(), found.end(), holds); };
  refuse(name, any([](const Contact& c) { return c.cohesion > 0; }), "cohesion");
  refuse(name, any([](const Contact& c) { return c.softness > 0; }), "compliant contacts");
  refuse(name, any([](const Contact& c) { return c.sigma > 0; }), "spinning friction");
}

/// Unit normal and two tangents.
struct Frame {
  Vec3d n, t, s;

  explicit Frame(const Contact& c) {
    n = static_cast<Vec3d>(c.normal);
    n *= 1 / std::sqrt(dot(n, n));
    const Vec3d aside = std::fabs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    t = cross(n, aside);
    t *= 1 / std::sqrt(dot(t, t));
    s = cross(n, t);
  }
};

double row_product(const std::array<double, kFreedoms>& a, const std::array<double, kFreedoms>& b) {
  double sum = 0;
  for (int k = 0; k < kFreedoms; ++k) sum += a[k] * b[k];
  return sum;
}

double root_of(Real inverse) { return std::sqrt(double(inverse)); }

}  // namespace

StepProblem::StepProblem(const std::string& name, const SceneWorld& world, const std::vector<BodyState>& before,
                         const std::vector<Contact>& found, double step, std::size_t most_whole) {
  check(name, world, found);
  for (const Contact& c : found)
    if (c.rho > 0) local_.dimension = 5;
  for (std::size_t b = 0; b < before.size(); ++b) {
    const BodyMass& m = world.mass[b];
    const Quat& q = before[b].orientation;
    Root root{{root_of(m.inverse_mass.x), root_of(m.inverse_mass.y), root_of(m.inverse_mass.z)}, {}};
    const Vec3& i = m.inverse_inertia_B;
    const Vec3 axis[3] = {rotate(q, {1, 0, 0}), rotate(q, {0, 1, 0}), rotate(q, {0, 0, 1})};
    const Real inverse[3] = {i.x, i.y, i.z};
    for (int k = 0; k < 3; ++k) root.turn[k] = root_of(inverse[k]) * static_cast<Vec3d>(axis[k]);
    root_.push_back(root);
  }
  set_free_motion(world, before, step);
  form_.body_count = Index(before.size());
  add_contacts(found);
  if (form_.contact.empty()) throw InputError(name + ": the step has no contact; take a scene in which bodies touch");
  std::vector<double> q = std::move(local_.q), mu = std::move(local_.mu), roll = std::move(local_.mu_roll);
  const auto ends = ends_of_bodies();
  std::size_t blocks = 0;
  for (const auto& of_body : ends) blocks += of_body.size() * of_body.size();
  const bool is_whole = blocks <= most_whole;
  local_ = make_problem(name, local_.dimension, is_whole ? delassus(ends) : diagonal_blocks(), std::move(q),
                        std::move(mu), std::move(roll));
  local_.bodies = std::make_shared<const BodyForm>(form_);
  local_.is_whole = is_whole;
}

void StepProblem::set_free_motion(const SceneWorld& world, const std::vector<BodyState>& before, double step) {
  for (std::size_t b = 0; b < before.size(); ++b) {
    const BodyMass& m = world.mass[b];
    const Vec3 &i = m.inverse_mass, &g = world.gravity, &turn = m.inverse_inertia_B;
    Vec3d v = static_cast<Vec3d>(before[b].velocity), w = static_cast<Vec3d>(before[b].angular_velocity);
    v += step * Vec3d{i.x > 0 ? g.x : 0, i.y > 0 ? g.y : 0, i.z > 0 ? g.z : 0};
    if (turn.x != turn.y || turn.y != turn.z) {
      const Vec3 spin_B = rotate_back(before[b].orientation, before[b].angular_velocity);
      w += static_cast<Vec3d>(rotate(before[b].orientation, free_spin_change_B(turn, spin_B, Real(step))));
    }
    const Root& root = root_[b];
    Freedoms free{};
    const double linear[3] = {root.linear.x, root.linear.y, root.linear.z}, speed[3] = {v.x, v.y, v.z};
    for (int k = 0; k < 3; ++k) {
      const double square = gonogo::dot(root.turn[k], root.turn[k]);
      free[k] = linear[k] > 0 ? speed[k] / linear[k] : 0;
      free[3 + k] = square > 0 ? gonogo::dot(root.turn[k], w) / square : 0;
    }
    linear_.push_back(v);
    spin_.push_back(w);
    free_.push_back(free);
  }
}

StepProblem::Freedoms StepProblem::scaled_row(BodyIndex body, const Vec3d& linear, const Vec3d& angular) const {
  const Root& g = root_[body];
  return {g.linear.x * linear.x,           g.linear.y * linear.y,           g.linear.z * linear.z,
          gonogo::dot(g.turn[0], angular), gonogo::dot(g.turn[1], angular), gonogo::dot(g.turn[2], angular)};
}

void StepProblem::add_contacts(const std::vector<Contact>& found) {
  const int d = local_.dimension;
  for (std::size_t place = 0; place < found.size(); ++place) {
    const Contact& c = found[place];
    const Frame f(c);
    const Vec3d push[5] = {f.n, f.t, f.s, {}, {}}, turn[5] = {{}, {}, {}, f.t, f.s};
    const BodyIndex body[2] = {c.body_a, c.body_b};
    const Vec3d arm[2] = {static_cast<Vec3d>(c.arm_a), static_cast<Vec3d>(c.arm_b)};
    BodyForm::Contact record{};
    double q[5] = {c.gap_bias, 0, 0, 0, 0}, normal = 0;
    for (int k = 0; k < 2; ++k) {
      const double sign = k == 0 ? 1 : -1;
      const BodyIndex b = body[k];
      for (int a = 0; a < d; ++a) {
        const Vec3d linear = sign * push[a], angular = sign * (cross(arm[k], push[a]) + turn[a]);
        record.row[k][a] = scaled_row(b, linear, angular);
        q[a] += gonogo::dot(linear, linear_[b]) + gonogo::dot(angular, spin_[b]);
      }
      const Root& g = root_[b];
      double mobility = gonogo::dot(g.linear, g.linear);
      for (const Vec3d& axis : g.turn) mobility += gonogo::dot(axis, axis);
      record.body[k] = mobility > 0 ? b : -1;
      normal += row_product(record.row[k][0], record.row[k][0]);
    }
    if (!(normal > 0)) continue;
    form_.contact.push_back(record);
    place_.push_back(place);
    local_.q.insert(local_.q.end(), q, q + d);
    local_.mu.push_back(c.mu);
    if (d == 5) local_.mu_roll.push_back(c.rho);
  }
}

std::vector<std::vector<StepProblem::End>> StepProblem::ends_of_bodies() const {
  std::vector<std::vector<End>> ends(std::size_t(form_.body_count));
  for (std::size_t i = 0; i < form_.contact.size(); ++i)
    for (int k = 0; k < 2; ++k)
      if (const Index b = form_.contact[i].body[k]; b >= 0) ends[std::size_t(b)].push_back({Index(i), k});
  return ends;
}

std::vector<Triplet> StepProblem::delassus(const std::vector<std::vector<End>>& ends) const {
  const int d = local_.dimension;
  std::size_t blocks = 0;
  for (const auto& of_body : ends) blocks += of_body.size() * of_body.size();
  std::vector<Triplet> w;
  w.reserve(blocks * std::size_t(d * d));
  for (const auto& of_body : ends)
    for (const End& i : of_body)
      for (const End& j : of_body)
        for (int a = 0; a < d; ++a)
          for (int b = 0; b < d; ++b)
            w.push_back(
                {i.contact * d + a, j.contact * d + b,
                 row_product(form_.contact[i.contact].row[i.side][a], form_.contact[j.contact].row[j.side][b])});
  return w;
}

std::vector<Triplet> StepProblem::diagonal_blocks() const {
  const int d = local_.dimension;
  std::vector<Triplet> w;
  for (std::size_t i = 0; i < form_.contact.size(); ++i)
    for (int k = 0; k < 2; ++k)
      for (int a = 0; a < d && form_.contact[i].body[k] >= 0; ++a)
        for (int b = 0; b < d; ++b)
          w.push_back({Index(i) * d + a, Index(i) * d + b,
                       row_product(form_.contact[i].row[k][a], form_.contact[i].row[k][b])});
  return w;
}

std::vector<double> StepProblem::impulses(const std::vector<Contact>& found,
                                          const std::vector<Impulse>& of_engine) const {
  std::vector<double> r;
  for (const std::size_t place : place_) {
    const Frame f(found[place]);
    const Vec3d push = static_cast<Vec3d>(of_engine[place].linear), turn = static_cast<Vec3d>(of_engine[place].angular);
    r.insert(r.end(), {gonogo::dot(push, f.n), gonogo::dot(push, f.t), gonogo::dot(push, f.s)});
    if (local_.dimension == 5) r.insert(r.end(), {gonogo::dot(turn, f.t), gonogo::dot(turn, f.s)});
  }
  return r;
}

StepMotion StepProblem::motion(const std::vector<double>& r) const {
  std::vector<Freedoms> y = free_;
  const int d = local_.dimension;
  for (std::size_t i = 0; i < form_.contact.size(); ++i)
    for (int k = 0; k < 2; ++k)
      if (const Index b = form_.contact[i].body[k]; b >= 0)
        for (int a = 0; a < d; ++a)
          for (int f = 0; f < kFreedoms; ++f) y[b][f] += form_.contact[i].row[k][a][f] * r[i * std::size_t(d) + a];
  StepMotion out;
  for (std::size_t b = 0; b < y.size(); ++b) {
    out.kinetic_energy += row_product(y[b], y[b]) / 2;
    const Vec3d& g = root_[b].linear;
    out.momentum += Vec3d{g.x > 0 ? y[b][0] / g.x : 0, g.y > 0 ? y[b][1] / g.y : 0, g.z > 0 ? y[b][2] / g.z : 0};
  }
  return out;
}

}  // namespace gonogo::sim
