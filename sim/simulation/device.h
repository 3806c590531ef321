// The GPUs of this machine.
#pragma once
#include <string>
#include <vector>

namespace gonogo::sim {

/// Names of the CUDA devices; empty where there are none and in a build without CUDA.
std::vector<std::string> cuda_device_names();

/// Throws InputError, saying why, where there is no CUDA device.
void require_cuda_device();

/// Simulations that this thread makes from now on are on this device, counted from 0. Throws InputError when there is
/// none of that number.
void use_cuda_device(int index);

}  // namespace gonogo::sim
