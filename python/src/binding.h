// Shared by all parts of the modules: calls without the GIL, arrays, values, and the list of parts.
#pragma once
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <unistd.h>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/json/json.h"
#include "base/progress.h"
#include "sim/simulation/layout/part.h"
#include "sim/simulation/simulation.h"
#include "vehicle/world/driving.h"

namespace gonogo::python {

/// Runs long work with the GIL released. On the main thread Ctrl-C sets the library's flag meanwhile, and the work
/// throws Cancelled, which Python sees as KeyboardInterrupt. Python runs signal handlers on its main thread alone.
template <class Work>
auto long_call(Work&& work) {
  std::optional<CancelScope> scope;
  if (getpid() == gettid()) scope.emplace();
  nanobind::gil_scoped_release released;
  return work();
}

/// Throws InputError for a number of GPUs that no world can be divided over.
inline void check_gpus(int count) {
  if (count < 1 || count > sim::kMaxGpus)
    throw InputError("gpus: " + std::to_string(count) + " given, allowed are 1 to " + std::to_string(sim::kMaxGpus));
}

/// Arrays of numpy over memory of C++.
template <class T>
using Array = nanobind::ndarray<nanobind::numpy, T>;
/// In memory of any device: numpy, torch, cupy and jax take it by from_dlpack().
template <class T>
using DeviceArray = nanobind::ndarray<nanobind::array_api, T>;
template <class T, int Dimensions>
using ArrayIn = nanobind::ndarray<const T, nanobind::ndim<Dimensions>, nanobind::c_contig, nanobind::device::cpu>;

/// The vector becomes the array's memory.
template <class T>
Array<T> array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto* owner = new std::vector<T>(std::move(values));
  nanobind::capsule free_it(owner, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Array<T>(owner->data(), shape, free_it);
}
template <class T>
Array<T> array_of(std::vector<T>&& values) {
  const std::size_t count = values.size();
  return array_of(std::move(values), {count});
}

/// Component `first` and those after it of every record in `records`: a view, kept valid by `owner`.
template <class T, class Record>
Array<const T> field_of(const std::vector<Record>& records, const T* first, std::size_t width, nanobind::handle owner) {
  static_assert(sizeof(Record) % sizeof(T) == 0);
  const std::size_t shape[] = {records.size(), width};
  const std::int64_t strides[] = {sizeof(Record) / sizeof(T), 1};
  return Array<const T>(first, width > 1 ? 2 : 1, shape, owner, strides);
}

inline std::vector<double> vector_of(const ArrayIn<double, 1>& array) {
  return std::vector<double>(array.data(), array.data() + array.size());
}

/// A result of the library as Python's own values: dict, list, str, int, float, bool and None; numbers that JSON cannot
/// hold are None. Needs the GIL.
inline nanobind::object to_python(const Json& json) {
  namespace nb = nanobind;
  if (json.is_object()) {
    nb::dict members;
    for (const auto& [name, value] : json.members()) members[name.c_str()] = to_python(value);
    return members;
  }
  if (json.is_array()) {
    nb::list items;
    for (const Json& item : json.items()) items.append(to_python(item));
    return items;
  }
  if (json.is_string()) return nb::str(json.string().data(), json.string().size());
  if (json.is_bool()) return nb::bool_(json.boolean());
  if (json.is_integer()) return json.number() < 0 ? nb::int_(json.integer()) : nb::int_(json.unsigned_integer());
  if (json.is_number() && std::isfinite(json.number())) return nb::float_(json.number());
  return nb::none();
}

/// A dict of names.
using Members = nanobind::typed<nanobind::dict, nanobind::str, nanobind::any>;
inline Members members_of(const Json& json) { return nanobind::borrow<Members>(to_python(json)); }

// The parts of the module gonogo._core.
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

// States of bodies and contacts as Python gets them: memory that arrays look into. Vehicles that Python drives.

/// All bodies of a world at one time.
struct Bodies {
  std::vector<sim::BodyState> state;
};

/// The same in memory of the device that simulates.
struct DeviceBodies {
  sim::BodiesOnDevice on;
};

/// All contacts of a world's latest step.
struct Contacts {
  std::vector<sim::Contact> contact;
  std::vector<sim::Impulse> impulse;
};

/// Numbers of a world's parts.
struct WorldParts {
  Index bodies = 0, motors = 0, controllers = 0, drivelines = 0;

  /// Whether everything of the smaller world exists here.
  bool holds(const WorldParts& o) const {
    return o.bodies <= bodies && o.motors <= motors && o.controllers <= controllers && o.drivelines <= drivelines;
  }
};

/// A vehicle in a world.
struct Driven {
  std::shared_ptr<vehicle::Vehicle> vehicle;  // `parts` points into it
  vehicle::DrivenVehicle parts;
  WorldParts world;  // when the vehicle had been added
};

}  // namespace gonogo::python
