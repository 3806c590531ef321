#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/format.h"
#include "base/units.h"
#include "python/src/binding.h"
#include "sim/simulation/parts/divided.h"
#include "sim/simulation/simulation.h"
#include "terrain/bed/bed.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

void check_divisible(const std::vector<sim::SceneWorld>& worlds, int gpus) {
  check_gpus(gpus);
  if (gpus > 1 && worlds.size() > 1)
    throw InputError("gpus: one world is divided over GPUs, and " + std::to_string(worlds.size()) +
                     " are given; make a simulation of each, or leave gpus out");
}

/// Worlds by number, checked: the engine trusts its indices.
class Batch {
 public:
  /// `watched`: says which step was not solved first, and which contact the relaxation opened too far first. Beds of
  /// grains take loose steps on purpose.
  Batch(const std::vector<sim::SceneWorld>& worlds, const sim::StepSettings& settings, int threads, bool gpu,
        std::optional<int> gpus, bool watched)
      : group_(watched && !gpu && !gpus ? 1 : 10),
        watched_(watched),
        relaxed_(watched && settings.target == sim::Target::ccp),
        in_a_row_(worlds.size(), 0) {
    if (worlds.empty()) throw InputError("simulation: at least one world is needed");
    for (const sim::SceneWorld& w : worlds) {
      size_.push_back(
          {Index(w.body.size()), Index(w.motor.size()), Index(w.controller.size()), Index(w.driveline.size())});
      gravity_.push_back(std::sqrt(dot(w.gravity, w.gravity)));
    }
    if (gpus) check_divisible(worlds, *gpus);
    const sim::Backend backend = gpu || gpus ? sim::Backend::cuda : sim::Backend::cpu;
    simulation_ = gpus > 1 ? sim::make_team_simulation(backend, worlds.front(), settings, *gpus)
                           : sim::make_simulation(backend, worlds, settings, threads);
  }

  sim::Simulation& at(sim::WorldIndex world) {
    if (world < 0 || std::size_t(world) >= size_.size())
      throw InputError("world " + std::to_string(world) + ": there are " + std::to_string(size_.size()));
    return *simulation_;
  }
  sim::Simulation& with_body(sim::WorldIndex world, sim::BodyIndex body) {
    sim::Simulation& simulation = at(world);
    if (body < 0 || body >= size_[std::size_t(world)].bodies)
      throw InputError("body " + std::to_string(body) + ": world " + std::to_string(world) + " has " +
                       std::to_string(size_[std::size_t(world)].bodies));
    return simulation;
  }
  sim::Simulation& with_motor(sim::WorldIndex world, Index motor) {
    sim::Simulation& simulation = at(world);
    if (motor < 0 || motor >= size_[std::size_t(world)].motors)
      throw InputError("motor " + std::to_string(motor) + ": world " + std::to_string(world) + " has " +
                       std::to_string(size_[std::size_t(world)].motors));
    return simulation;
  }
  void drive(const Driven& v, double throttle, double steering, sim::WorldIndex world) {
    sim::Simulation& simulation = at(world);
    if (!size_[std::size_t(world)].holds(v.world))
      throw InputError("drive: the vehicle was added to another world than world " + std::to_string(world));
    vehicle::set_controls(simulation, world, v.parts, throttle, steering);
  }
  /// For one world, or for all without a number.
  sim::BodiesOnDevice bodies_on_device(std::optional<sim::WorldIndex> world) {
    if (world) return at(*world).bodies_on_device(*world, 1);
    return simulation_->bodies_on_device(0, sim::WorldIndex(size_.size()));
  }
  std::size_t size() const { return size_.size(); }

  /// Steps in small groups, between which Ctrl-C is seen. Returns sentences on the first step of all that is not solved
  /// and on the first contact that the relaxation opens too far, when they are met.
  std::vector<std::string> advance(Index count) {
    if (count < 0) throw InputError("step: " + std::to_string(count) + " steps asked, at least 0 needed");
    std::vector<std::string> met;
    for (Index done = 0; done < count; done += group_) {
      stop_if_cancelled();
      simulation_->advance(std::min(group_, count - done));
      if (watched_ && unsolved_.empty()) {
        look_for_unsolved();
        if (!unsolved_.empty()) met.push_back(unsolved_);
      }
      if (relaxed_)
        if (const std::string lift = found_lift(); !lift.empty()) {
          relaxed_ = false;  // said once
          met.push_back(lift);
        }
    }
    return met;
  }
  const std::string& unsolved() const { return unsolved_; }
  double step() const { return simulation_->settings().step; }

 private:
  static constexpr int kUnsolvedInARow = 3;

  /// Steps are not solved when the residual stays above the tolerance and above half of what gravity adds in a step:
  /// contacts then do not carry the weights on them. A single such step, as of an impact, heals in the next ones.
  void look_for_unsolved() {
    const sim::StepSettings& s = simulation_->settings();
    const double bound = std::max(double(s.tolerance), 0.5 * kGravity * double(s.substep()));
    const std::vector<sim::StepReport> reports = simulation_->reports();
    for (std::size_t w = 0; w < reports.size() && unsolved_.empty(); ++w) {
      in_a_row_[w] = reports[w].max_residual > bound ? in_a_row_[w] + 1 : 0;
      if (in_a_row_[w] == kUnsolvedInARow)
        unsolved_ = line(
            "simulation: the steps up to %.4g s are not solved in world %zu: the residual is %.2g m/s after %d "
            "iterations, above %.2g m/s, so that forces and motion are wrong; give more than iterations=%d, or let "
            "masses that touch differ less",
            reports[w].time, w, reports[w].max_residual, int(reports[w].iterations), bound, int(s.iterations));
    }
  }

  /// The sentence on a contact that opens so fast that its body rises above the envelope.
  std::string found_lift() {
    const double envelope = simulation_->settings().envelope;
    for (std::size_t w = 0; w < size_.size(); ++w) {
      const auto world = sim::WorldIndex(w);
      const std::vector<sim::Contact> contacts = simulation_->contacts(world);
      if (contacts.empty() || gravity_[w] == 0) continue;
      const std::vector<sim::Impulse> impulses = simulation_->impulses(world);
      const std::vector<sim::BodyState> bodies = simulation_->bodies(world);
      const auto velocity = [&](sim::BodyIndex b) {
        const sim::BodyState& body = bodies[std::size_t(b)];
        return sim::Velocity{.linear = body.velocity, .angular = body.angular_velocity};
      };
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        const sim::Contact& c = contacts[k];
        const sim::Velocity a = velocity(c.body_a), b = velocity(c.body_b);
        const double opening = dot(c.normal, sim::contact_velocity<Real>(c, a, b));
        const double lift = opening * opening / (2 * gravity_[w]);
        if (c.softness > 0 || opening <= 0 || lift <= envelope || dot(impulses[k].linear, c.normal) <= 0) continue;
        return line(
            "simulation: at %.4g s bodies %d and %d of world %zu slide on each other at %.3g m/s and part at %.3g m/s, "
            "as "
            "the convex relaxation has it, which lifts by up to %.2g m: more than the %.2g m within which contacts are "
            "found; take target=\"coulomb\", under which they stay together",
            simulation_->reports()[w].time, int(c.body_a), int(c.body_b), w, double(sim::slip_speed<Real>(c, a, b)),
            opening, lift, envelope);
      }
    }
    return "";
  }

  std::vector<WorldParts> size_;
  std::vector<double> gravity_;  // [world] [m/s^2]
  std::unique_ptr<sim::Simulation> simulation_;
  Index group_;
  bool watched_;
  bool relaxed_;               // contacts are looked at for lifts
  std::vector<int> in_a_row_;  // [world] steps that were not solved, up to now
  std::string unsolved_;
};

sim::StepSettings settings_of(double step, int iterations, double tolerance, std::optional<double> grain_diameter,
                              int substeps, const std::optional<std::string>& target) {
  sim::StepSettings settings;
  settings.target = sim::Target::coulomb;
  if (grain_diameter) settings = terrain::bed_step_settings(*grain_diameter, step, iterations, tolerance);
  if (target) settings.target = sim::target_named(*target);
  settings.step = Real(step);
  settings.iterations = iterations;
  settings.tolerance = Real(tolerance);
  settings.substeps = substeps;
  return settings;
}

Array<float> values3(const Vec3& v) { return array_of(std::vector<float>{v.x, v.y, v.z}); }

void bind_report(nb::module_& m) {
  nb::class_<sim::StepReport>(m, "StepReport", "One world after its latest step.")
      .def_ro("time", &sim::StepReport::time, "[s]")
      .def_ro("kinetic_energy", &sim::StepReport::kinetic_energy, "[J]")
      .def_ro("motor_power", &sim::StepReport::motor_power, "[W]")
      .def_ro("rms_residual", &sim::StepReport::rms_residual, "Over contacts [m/s].")
      .def_ro("max_residual", &sim::StepReport::max_residual, "[m/s]")
      .def_ro("contact_count", &sim::StepReport::contact_count)
      .def_ro("iterations", &sim::StepReport::iterations, "Of the solver, over all substeps.")
      .def_ro("flags", &sim::StepReport::flags, "0 while nothing has failed.");
}

}  // namespace

void bind_simulation(nb::module_& m) {
  using namespace nb::literals;
  using W = sim::WorldIndex;
  bind_report(m);
  nb::class_<sim::Snapshot>(m, "Snapshot", "State from which a world continues with the same bits.");
  nb::class_<Batch>(m, "Simulation", "A batch of worlds that take their steps together.")
      .def(
          "__init__",
          [](Batch* self, const std::vector<sim::SceneWorld>& worlds, double step, int iterations, double tolerance,
             std::optional<double> grain_diameter, int substeps, int threads, bool gpu,
             const std::optional<std::string>& target, std::optional<int> gpus) {
            const auto settings = settings_of(step, iterations, tolerance, grain_diameter, substeps, target);
            new (self) Batch(worlds, settings, threads, gpu, gpus, !grain_diameter);
          },
          "worlds"_a, "step"_a = 1e-3, "iterations"_a = 100, "tolerance"_a = 0.0,
          "grain_diameter"_a.none() = nb::none(), "substeps"_a = 1, "threads"_a = 1, "gpu"_a = false,
          "target"_a.none() = nb::none(), "gpus"_a.none() = nb::none(),
          "Step [s]; max iterations of the solver in a substep; residual at which it stops [m/s]. A grain diameter [m] "
          "sets the tolerances of contacts as beds of such grains need them. target: \"coulomb\", Coulomb's law, or "
          "\"ccp\", the convex relaxation, in which a sliding contact opens at friction x speed. None: coulomb, and "
          "ccp "
          "for a grain diameter, since the tables of soils are measured with it. gpus: number of GPUs over which one "
          "world is "
          "divided, with the same bits; None: with gpu, one.")
      .def(
          "step",
          [](Batch& b, Index count) {
            for (const std::string& sentence : long_call([&] { return b.advance(count); }))
              if (PyErr_WarnEx(PyExc_RuntimeWarning, sentence.c_str(), 1) < 0) throw nb::python_error();
          },
          "count"_a = 1,
          "Takes steps of all worlds. Warns once, with RuntimeWarning, when the contacts of a step are not solved, and "
          "once when target \"ccp\" lifts a sliding body out of contact.")
      .def_prop_ro(
          "unsolved", [](const Batch& b) { return b.unsolved(); },
          "The sentence on the first step that was not solved; empty while there is none. Not for worlds with a grain "
          "diameter, which take loose steps on purpose.")
      .def("__len__", &Batch::size)
      .def_prop_ro("step_size", &Batch::step, "[s]")
      .def(
          "report", [](Batch& b, W w) { return b.at(w).report(w); }, "world"_a = 0)
      .def(
          "bodies", [](Batch& b, W w) { return long_call([&] { return Bodies{b.at(w).bodies(w)}; }); }, "world"_a = 0,
          "All bodies now, in the order in which they were added.")
      .def(
          "body", [](Batch& b, sim::BodyIndex body, W w) { return Bodies{{b.with_body(w, body).body(w, body)}}; },
          "body"_a, "world"_a = 0, "One body now: arrays of one row.")
      .def(
          "bodies_on_device",
          [](Batch& b, std::optional<W> w) { return long_call([&] { return DeviceBodies{b.bodies_on_device(w)}; }); },
          "world"_a.none() = nb::none(),
          "All bodies now, in memory of the device that simulates: arrays for from_dlpack() of torch, cupy, jax or "
          "numpy. "
          "None: of all worlds, one after the other.")
      .def("drive", &Batch::drive, "vehicle"_a, "throttle"_a, "steering"_a = 0.0, "world"_a = 0,
           "Holds throttle and steering, both -1 to 1, from now on. Throttle below zero brakes, or with wheel motors "
           "drives backwards. Steering above zero turns to the left.")
      .def(
          "contacts",
          [](Batch& b, W w) { return long_call([&] {
                                return Contacts{b.at(w).contacts(w), b.at(w).impulses(w)};
                              }); },
          "world"_a = 0, "All contacts of the latest step.")
      .def(
          "contact_force",
          [](Batch& b, sim::BodyIndex body, W w) { return values3(Vec3(b.with_body(w, body).contact_force(w, body))); },
          "body"_a, "world"_a = 0, "Sum of the contact forces on a body in the last substep [3] [N].")
      .def(
          "set_gravity",
          [](Batch& b, const std::array<double, 3>& g, W w) {
            b.at(w).set_gravity(w, {Real(g[0]), Real(g[1]), Real(g[2])});
          },
          "gravity"_a, "world"_a = 0, "[m/s^2]")
      .def(
          "set_motor",
          [](Batch& b, Index motor, double target, double max_torque, W w) {
            b.with_motor(w, motor).set_motor(w, motor, Real(target), Real(max_torque));
          },
          "motor"_a, "target"_a, "max_torque"_a, "world"_a = 0, "Speed [rad/s] and max torque [N m].")
      .def(
          "motor_torque", [](Batch& b, Index motor, W w) { return b.with_motor(w, motor).motor_torque(w, motor); },
          "motor"_a, "world"_a = 0, "In the last substep [N m].")
      .def(
          "snapshot", [](Batch& b, W w) { return b.at(w).snapshot(w); }, "world"_a = 0)
      .def(
          "restore", [](Batch& b, const sim::Snapshot& s, W w) { b.at(w).restore(w, s); }, "snapshot"_a, "world"_a = 0);
  m.def("cuda_device_names", &sim::cuda_device_names, "GPUs that this build can use.");
}

}  // namespace gonogo::python
