// Load increments and Newmark's method, with steps that shrink where Newton fails and where slip turns to stick.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "sim/elastic/newton.h"

namespace gonogo::sim::elastic {
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

}  // namespace gonogo::sim::elastic
