// Attributes of the current GPU, for .cu files.
#pragma once
#include <cuda_runtime.h>

#include "base/parallel/buffer.h"

namespace gonogo {

/// Throws DeviceError when no GPU answers.
inline int device_attribute(cudaDeviceAttr attribute) {
  int device = 0, value = 0;
  check_cuda(cudaGetDevice(&device), "device");
  check_cuda(cudaDeviceGetAttribute(&value, attribute, device), "device attribute");
  return value;
}

}  // namespace gonogo
