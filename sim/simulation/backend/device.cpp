#include "sim/simulation/device.h"

#include "base/error.h"
#ifdef GONOGO_WITH_CUDA
#include <cuda_runtime_api.h>
#endif

namespace gonogo::sim {

std::vector<std::string> cuda_device_names() {
  std::vector<std::string> names;
#ifdef GONOGO_WITH_CUDA
  int count = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess) return names;
  for (int k = 0; k < count; ++k) {
    cudaDeviceProp properties;
    if (cudaGetDeviceProperties(&properties, k) == cudaSuccess) names.push_back(properties.name);
  }
#endif
  return names;
}

void require_cuda_device() {
#ifdef GONOGO_WITH_CUDA
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count > 0) return;
  throw InputError(std::string("no CUDA device answers on this machine (") +
                   (status != cudaSuccess ? cudaGetErrorString(status) : "there is none") +
                   "); ask for the cpu backend");
#else
  throw InputError("this program was built without CUDA; build the cuda-release preset or ask for the cpu backend");
#endif
}

void use_cuda_device(int index) {
  const std::size_t count = cuda_device_names().size();
  if (index < 0 || std::size_t(index) >= count)
    throw InputError("there is no GPU number " + std::to_string(index) + " (counted from 0); this machine has " +
                     std::to_string(count));
#ifdef GONOGO_WITH_CUDA
  if (const cudaError_t error = cudaSetDevice(index); error != cudaSuccess)
    throw DeviceError("GPU " + std::to_string(index) + ": " + cudaGetErrorString(error));
#endif
}

}  // namespace gonogo::sim
