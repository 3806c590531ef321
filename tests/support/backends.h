// The backends of this build and machine: the CPU always, CUDA when it was built in and a device answers.
#pragma once
#include <vector>

#include "base/error.h"
#include "sim/simulation/simulation.h"

namespace gonogo::test {

inline const char* name_of(sim::Backend backend) { return backend == sim::Backend::cpu ? "cpu" : "cuda"; }

/// A build without CUDA and a machine without a device refuse with InputError; any other trouble of the device is a
/// DeviceError and fails the test.
inline const std::vector<sim::Backend>& backends() {
  static const std::vector<sim::Backend> found = [] {
    std::vector<sim::Backend> list{sim::Backend::cpu};
    try {
      sim::require_backend(sim::Backend::cuda);
      list.push_back(sim::Backend::cuda);
    } catch (const InputError&) {
    }
    return list;
  }();
  return found;
}

}  // namespace gonogo::test
