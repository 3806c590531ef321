#include "pipeline/campaign/trial/trial.h"
#include "pipeline/campaign/study/contract.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "base/files/shipped.h"
#include "pipeline/campaign/setup/read_setup.h"
#include "python/src/binding.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

using Values = std::map<std::string, double>;

struct Trial {
  campaign::TrialSetup setup;
  campaign::DesignPoint point;
};

void set_values(campaign::DesignPoint& point, const Values& values) {
  for (const auto& [name, value] : values) campaign::set_value(point.variables, name, value, name);
}

Trial trial_of_study(const std::string& file, const Values& values, std::uint64_t seed) {
  return long_call([&] {
    const campaign::Study study = campaign::read_study(file);
    Trial t{campaign::read_trial_setup(study), {}};
    t.point.seed = seed;
    t.point.variables = campaign::middle_values(study);
    set_values(t.point, values);
    campaign::check_all_given(t.point.variables, file);
    return t;
  });
}

Trial trial_of_vehicle(const std::string& vehicle, const std::string& soil, const std::string& task,
                       const Values& values, std::uint64_t seed) {
  return long_call([&] {
    Trial t{campaign::vehicle_trial_setup(shipped_file("vehicles", "vehicle", vehicle),
                                          shipped_file("soils", "calibration", soil),
                                          task.empty() ? campaign::default_task() : campaign::parse_task(task)),
            {}};
    t.point.seed = seed;
    t.point.variables = campaign::usual_values(t.setup);
    set_values(t.point, values);
    return t;
  });
}

/// A trial's moment, for the length of the call that gets it.
struct Frame {
  campaign::TrialSample sample;
  const campaign::TrialFrame* now = nullptr;  // null once the call is over

  const campaign::TrialFrame& running() const {
    if (!now) throw InputError("frame: the trial has gone on; read its bodies before the next frame");
    return *now;
  }
};

/// Calls Python with a frame, and takes the trial away from the frame afterwards, however the call ends.
void show(const nb::object& on_frame, const campaign::TrialFrame& frame) {
  nb::gil_scoped_acquire acquired;
  const nb::object shown = nb::cast(Frame{frame.sample, &frame});
  struct End {
    Frame& frame;
    ~End() { frame.now = nullptr; }
  } const end{nb::cast<Frame&>(shown)};
  on_frame(shown);
}

campaign::TrialRecord run(const Trial& trial, const nb::object& on_frame, double frame_interval, int threads, bool gpu,
                          std::optional<int> gpus) {
  campaign::TrialWatch watch;
  if (!on_frame.is_none()) watch.frame = [&](const campaign::TrialFrame& frame) { show(on_frame, frame); };
  watch.frame_interval = frame_interval;
  if (gpus) check_gpus(*gpus);
  const campaign::TrialDevice device{gpu || gpus ? sim::Backend::cuda : sim::Backend::cpu, threads, gpus.value_or(0)};
  return long_call([&] {
    // Nothing polls the flag while a trial without a checkpoint file runs; its samples come after every look.
    watch.sample = [](const campaign::TrialSample&) { stop_if_cancelled(); };
    return campaign::run_trial(trial.setup, trial.point, watch, {}, device);
  });
}

nb::typed<nb::dict, nb::str, double> measures_of(const campaign::TrialRecord& record) {
  nb::dict result;
  for (std::size_t k = 0; k < record.measures.size(); ++k)
    if (campaign::has_measure(record, k)) result[campaign::contract().measures[k].name.c_str()] = record.measures[k];
  return result;
}

nb::typed<nb::dict, nb::str, double> variables_of(const campaign::DesignPoint& point) {
  const bool with_task = campaign::has_task_values(point.variables);
  nb::dict result;
  for (std::size_t v = 0; v < point.variables.size(); ++v)
    if (const campaign::Variable& variable = campaign::contract().variables[v];
        campaign::has_column(variable, with_task))
      result[variable.name.c_str()] = point.variables[v];
  return result;
}

void bind_record(nb::module_& m) {
  using Record = campaign::TrialRecord;
  nb::class_<Record>(m, "TrialRecord", "How a trial ended.")
      .def_prop_ro(
          "verdict", [](const Record& r) { return campaign::contract().info(r.verdict).name; },
          "\"go\", \"slow_go\", \"no_go\" or \"unknown\".")
      .def_prop_ro("reason", [](const Record& r) { return campaign::contract().info(r.reason).name; })
      .def_prop_ro(
          "variables", [](const Record& r) { return variables_of(r.point); }, "In the units of the contract.")
      .def_prop_ro("measures", &measures_of, "In the units of the contract; NaN where there is none.")
      .def_ro("attempts", &Record::attempts)
      .def_prop_ro("failed_checks", [](const Record& r) { return campaign::names_of_checks(r.failed_checks); });
}

void bind_frame(nb::module_& m) {
  nb::class_<Frame>(m, "Frame", "A moment of a running trial.")
      .def_prop_ro(
          "time", [](const Frame& f) { return f.sample.time; }, "From letting the wheel down [s].")
      .def_prop_ro(
          "x", [](const Frame& f) { return f.sample.x; }, "Travelled [m].")
      .def_prop_ro(
          "y", [](const Frame& f) { return f.sample.y; }, "[m]")
      .def_prop_ro(
          "sinkage", [](const Frame& f) { return f.sample.sinkage; }, "[m]")
      .def_prop_ro(
          "speed", [](const Frame& f) { return f.sample.speed; }, "[m/s]")
      .def_prop_ro(
          "slip", [](const Frame& f) { return f.sample.slip; }, "Slip ratio of the whole way [-].")
      .def_prop_ro(
          "torque", [](const Frame& f) { return f.sample.torque; }, "[N m]")
      .def_prop_ro(
          "residual", [](const Frame& f) { return f.sample.residual; }, "RMS over contacts [m/s].")
      .def_prop_ro("contact_count", [](const Frame& f) { return f.sample.contacts; })
      .def_prop_ro("iterations", [](const Frame& f) { return f.sample.iterations; })
      .def_prop_ro(
          "wheel", [](const Frame& f) { return f.running().wheel; }, "Index of its body; -1 without one.")
      .def(
          "bodies",
          [](const Frame& f) {
            const campaign::TrialFrame& now = f.running();
            return Bodies{now.simulation.bodies(now.place)};
          },
          "All bodies now. Valid until the next frame; the arrays stay.")
      .def(
          "bodies_on_device",
          [](const Frame& f) {
            const campaign::TrialFrame& now = f.running();
            return DeviceBodies{now.simulation.bodies_on_device(now.place, 1)};
          },
          "The same in memory of the device that simulates, for from_dlpack().")
      .def(
          "contacts",
          [](const Frame& f) {
            const campaign::TrialFrame& now = f.running();
            return Contacts{now.simulation.contacts(now.place), now.simulation.impulses(now.place)};
          },
          "All contacts now. Valid until the next frame; the arrays stay.");
}

}  // namespace

void bind_trial(nb::module_& m) {
  using namespace nb::literals;
  bind_record(m);
  bind_frame(m);
  nb::class_<Trial>(m, "Trial", "One trial: setup and values of its variables.")
      .def_static("of_study", &trial_of_study, "study"_a, "values"_a, "seed"_a)
      .def_static("of_vehicle", &trial_of_vehicle, "vehicle"_a, "soil"_a, "task"_a, "values"_a, "seed"_a)
      .def_prop_ro(
          "variables", [](const Trial& t) { return variables_of(t.point); }, "In the units of the contract.")
      .def_prop_ro(
          "step_size", [](const Trial& t) { return t.setup.numerics.step; }, "Of the first attempt [s].")
      .def_prop_ro(
          "time_limit", [](const Trial& t) { return t.setup.park_time + t.setup.time_limit; }, "[s]")
      .def("run", &run, "on_frame"_a.none() = nb::none(), "frame_interval"_a = 0.02, "threads"_a = 1, "gpu"_a = false,
           "gpus"_a.none() = nb::none(),
           "Runs the trial, on `gpus` GPUs or, with `gpu`, on as many as pay; on_frame(frame) at the start, at "
           "intervals [s] and at the end.");
}

}  // namespace gonogo::python
