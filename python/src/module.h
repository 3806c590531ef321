// The parts of the module gonogo._core.
#pragma once
#include <nanobind/nanobind.h>

namespace gonogo::python {

void bind_errors(nanobind::module_& m);
/// In another module: InputError and DeviceError are those of gonogo._core, so that one `except` catches both.
void raise_errors_of_core();
void bind_model(nanobind::module_& m);
void bind_machine(nanobind::module_& m);
void bind_problem(nanobind::module_& m);
void bind_dataset(nanobind::module_& m);
void bind_scene(nanobind::module_& m);
void bind_vehicle(nanobind::module_& m);
void bind_bodies(nanobind::module_& m);
void bind_simulation(nanobind::module_& m);
void bind_trial(nanobind::module_& m);
void bind_campaign(nanobind::module_& m);

}  // namespace gonogo::python
