#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>

#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"
#include "python/src/state.h"
#include "sim/simulation/device.h"
#include "terrain/bed/bed.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

/// Worlds by number, checked: the engine trusts its indices.
class Batch {
 public:
  Batch(const std::vector<sim::SceneWorld>& worlds, const sim::StepSettings& settings, int threads, bool gpu) {
    if (worlds.empty()) throw InputError("simulation: at least one world is needed");
    for (const sim::SceneWorld& w : worlds) {
      bodies_.push_back(sim::BodyIndex(w.body.size()));
      motors_.push_back(Index(w.motor.size()));
    }
    simulation_ = sim::make_simulation(gpu ? sim::Backend::cuda : sim::Backend::cpu, worlds, settings, threads);
  }

  sim::Simulation& at(sim::WorldIndex world) {
    if (world < 0 || std::size_t(world) >= bodies_.size())
      throw InputError("world " + std::to_string(world) + ": there are " + std::to_string(bodies_.size()));
    return *simulation_;
  }
  sim::Simulation& with_body(sim::WorldIndex world, sim::BodyIndex body) {
    sim::Simulation& simulation = at(world);
    if (body < 0 || body >= bodies_[std::size_t(world)])
      throw InputError("body " + std::to_string(body) + ": world " + std::to_string(world) + " has " +
                       std::to_string(bodies_[std::size_t(world)]));
    return simulation;
  }
  sim::Simulation& with_motor(sim::WorldIndex world, Index motor) {
    sim::Simulation& simulation = at(world);
    if (motor < 0 || motor >= motors_[std::size_t(world)])
      throw InputError("motor " + std::to_string(motor) + ": world " + std::to_string(world) + " has " +
                       std::to_string(motors_[std::size_t(world)]));
    return simulation;
  }
  std::size_t size() const { return bodies_.size(); }

  /// Steps in small groups, between which Ctrl-C is seen.
  void advance(Index count) {
    if (count < 0) throw InputError("step: " + std::to_string(count) + " steps asked, at least 0 needed");
    constexpr Index group = 10;
    for (Index done = 0; done < count; done += group) {
      stop_if_cancelled();
      simulation_->advance(std::min(group, count - done));
    }
  }
  double step() const { return simulation_->settings().step; }

 private:
  std::vector<sim::BodyIndex> bodies_;
  std::vector<Index> motors_;
  std::unique_ptr<sim::Simulation> simulation_;
};

sim::StepSettings settings_of(double step, int iterations, double tolerance, std::optional<double> grain_diameter,
                              int substeps) {
  sim::StepSettings settings;
  if (grain_diameter) settings = terrain::bed_step_settings(*grain_diameter, step, iterations, tolerance);
  settings.step = Real(step);
  settings.iterations = iterations;
  settings.tolerance = Real(tolerance);
  settings.substeps = substeps;
  return settings;
}

Array<float> values3(const Vec3& v) { return array_of(std::vector<float>{v.x, v.y, v.z}); }

void bind_bodies(nb::module_& m) {
  using Self = nb::handle_t<Bodies>;
  const auto all = [](Self self) -> const std::vector<sim::BodyState>& { return nb::cast<Bodies&>(self).state; };
  nb::class_<Bodies>(m, "Bodies", "All bodies of a world at one time. Arrays are views of one block of memory.")
      .def("__len__", [](const Bodies& b) { return b.state.size(); })
      .def_prop_ro(
          "position", [all](Self s) { return field_of(all(s), &all(s).data()->position.x, 3, s); },
          "Centres of mass [body, 3] [m].")
      .def_prop_ro(
          "orientation", [all](Self s) { return field_of(all(s), &all(s).data()->orientation.w, 4, s); },
          "Unit quaternions w, x, y, z [body, 4].")
      .def_prop_ro(
          "velocity", [all](Self s) { return field_of(all(s), &all(s).data()->velocity.x, 3, s); }, "[body, 3] [m/s].")
      .def_prop_ro(
          "angular_velocity", [all](Self s) { return field_of(all(s), &all(s).data()->angular_velocity.x, 3, s); },
          "[body, 3] [rad/s].");
}

void bind_contacts(nb::module_& m) {
  using Self = nb::handle_t<Contacts>;
  const auto all = [](Self self) -> const std::vector<sim::Contact>& { return nb::cast<Contacts&>(self).contact; };
  const auto push = [](Self self) -> const std::vector<sim::Impulse>& { return nb::cast<Contacts&>(self).impulse; };
  nb::class_<Contacts>(m, "Contacts", "All contacts of a world's latest step. Arrays are views.")
      .def("__len__", [](const Contacts& c) { return c.contact.size(); })
      .def_prop_ro(
          "body_a", [all](Self s) { return field_of(all(s), &all(s).data()->body_a, 1, s); }, "[contact]")
      .def_prop_ro(
          "body_b", [all](Self s) { return field_of(all(s), &all(s).data()->body_b, 1, s); }, "[contact]")
      .def_prop_ro(
          "normal", [all](Self s) { return field_of(all(s), &all(s).data()->normal.x, 3, s); },
          "Unit vectors from body b to body a [contact, 3].")
      .def_prop_ro(
          "gap", [all](Self s) { return field_of(all(s), &all(s).data()->gap, 1, s); },
          "Negative when the bodies overlap [contact] [m].")
      .def_prop_ro(
          "impulse", [push](Self s) { return field_of(push(s), &push(s).data()->linear.x, 3, s); },
          "On body a in the last substep [contact, 3] [N s].");
}

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
  bind_bodies(m);
  bind_contacts(m);
  bind_report(m);
  nb::class_<sim::Snapshot>(m, "Snapshot", "State from which a world continues with the same bits.");
  nb::class_<Batch>(m, "Simulation", "A batch of worlds that take their steps together.")
      .def(
          "__init__",
          [](Batch* self, const std::vector<sim::SceneWorld>& worlds, double step, int iterations, double tolerance,
             std::optional<double> grain_diameter, int substeps, int threads, bool gpu) {
            const auto settings = settings_of(step, iterations, tolerance, grain_diameter, substeps);
            new (self) Batch(worlds, settings, threads, gpu);
          },
          "worlds"_a, "step"_a = 1e-3, "iterations"_a = 100, "tolerance"_a = 0.0,
          "grain_diameter"_a.none() = nb::none(), "substeps"_a = 1, "threads"_a = 1, "gpu"_a = false,
          "Step [s]; max iterations of the solver in a substep; residual at which it stops [m/s]. A grain diameter [m] "
          "sets the tolerances of contacts as beds of such grains need them.")
      .def(
          "step", [](Batch& b, Index count) { long_call([&] { b.advance(count); }); }, "count"_a = 1,
          "Takes steps of all worlds.")
      .def("__len__", &Batch::size)
      .def_prop_ro("step_size", &Batch::step, "[s]")
      .def(
          "report", [](Batch& b, W w) { return b.at(w).report(w); }, "world"_a = 0)
      .def(
          "bodies", [](Batch& b, W w) { return long_call([&] { return Bodies{b.at(w).bodies(w)}; }); }, "world"_a = 0,
          "All bodies now, in the order in which they were added.")
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
