// Where loops run. A kernel body is a named struct with `operator()(Index) const`; for_each_index runs it for 0..n-1 on
// the host's cores or on the GPU. With exclusive_scan and atomic_increment this is all the parallelism sim/ uses, so a
// stage written once serves both. Results must not depend on the order in which the indices run.
#pragma once
#include "base/buffer.h"
#include "base/view.h"

#ifdef __CUDACC__
#include <cub/device/device_scan.cuh>
#endif

namespace gonogo {

/// Adds one and returns the value before; safe from many threads. Use only where order does not matter afterwards.
GONOGO_HD inline Index atomic_increment(Index& counter) {
#ifdef __CUDA_ARCH__
  return atomicAdd(&counter, 1);
#else
  return __atomic_fetch_add(&counter, 1, __ATOMIC_RELAXED);
#endif
}

/// Raises bits; safe from many threads.
GONOGO_HD inline void atomic_raise(Index& word, Index bits) {
#ifdef __CUDA_ARCH__
  atomicOr(&word, bits);
#else
  __atomic_fetch_or(&word, bits, __ATOMIC_RELAXED);
#endif
}

/// Below this many indices a second thread costs more than it saves.
inline constexpr Index kSerialBelow = 512;

template <class Body>
void for_each_index(Cpu exec, Index count, const Body& body) {
  if (exec.threads <= 1 || count < kSerialBelow) {
    for (Index i = 0; i < count; ++i) body(i);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(exec.threads)
  for (Index i = 0; i < count; ++i) body(i);
}

/// out[i] = in[0] + ... + in[i-1] for i = 0..count; out has one element more than in. Returns the total, out[count].
inline Index exclusive_scan(Cpu, View<const Index> in, View<Index> out) {
  Index sum = 0;
  for (Index i = 0; i < in.size; ++i) {
    const Index value = in[i];
    out[i] = sum;
    sum += value;
  }
  out[in.size] = sum;
  return sum;
}

#ifdef __CUDACC__
template <class Body>
__global__ void run_body(Index count, Body body) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) body(i);
}

template <class Body>
void for_each_index(Cuda exec, Index count, const Body& body) {
  if (count == 0) return;
  constexpr Index block = 128;
  run_body<<<(count + block - 1) / block, block, 0, static_cast<cudaStream_t>(exec.stream)>>>(count, body);
  check_cuda(cudaGetLastError(), "kernel launch");
}

inline Index exclusive_scan(Cuda exec, View<const Index> in, View<Index> out) {
  const auto stream = static_cast<cudaStream_t>(exec.stream);
  // Scanned in place with a zero appended, so that the last element becomes the total.
  check_cuda(cudaMemcpyAsync(out.data, in.data, sizeof(Index) * in.size, cudaMemcpyDeviceToDevice, stream), "copy");
  check_cuda(cudaMemsetAsync(out.data + in.size, 0, sizeof(Index), stream), "clear");
  std::size_t bytes = 0;
  check_cuda(cub::DeviceScan::ExclusiveSum(nullptr, bytes, out.data, out.data, in.size + 1, stream), "scan size");
  Buffer<std::uint8_t, Cuda> scratch(bytes);
  check_cuda(cub::DeviceScan::ExclusiveSum(scratch.data(), bytes, out.data, out.data, in.size + 1, stream), "scan");
  Index total = 0;
  check_cuda(cudaMemcpyAsync(&total, out.data + in.size, sizeof(Index), cudaMemcpyDeviceToHost, stream), "read total");
  check_cuda(cudaStreamSynchronize(stream), "scan");
  return total;
}
#endif

}  // namespace gonogo
