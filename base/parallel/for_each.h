// Parallel loops on the host's cores or the GPU. A kernel body is a named struct with `operator()(Index) const`;
// for_each_index runs it for 0..n-1. Stages use only these functions, so each is written once for both.
// Results must not depend on the order in which the indices run.
#pragma once
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "base/parallel/buffer.h"

#ifdef __CUDACC__
#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <cub/device/device_scan.cuh>
#endif

namespace gonogo {

/// Adds one and returns the old value. Thread-safe; use it only where the order does not matter afterwards.
GONOGO_HD inline Index atomic_increment(Index& counter) {
#ifdef __CUDA_ARCH__
  return atomicAdd(&counter, 1);
#else
  return __atomic_fetch_add(&counter, 1, __ATOMIC_RELAXED);
#endif
}

/// Adds integers, whose sum does not depend on the order. Thread-safe.
GONOGO_HD inline void atomic_add(Index& sum, Index value) {
#ifdef __CUDA_ARCH__
  atomicAdd(&sum, value);
#else
  __atomic_fetch_add(&sum, value, __ATOMIC_RELAXED);
#endif
}

/// Sets bits. Thread-safe.
GONOGO_HD inline void atomic_raise(Index& word, Index bits) {
#ifdef __CUDA_ARCH__
  atomicOr(&word, bits);
#else
  __atomic_fetch_or(&word, bits, __ATOMIC_RELAXED);
#endif
}

/// Keeps the smaller value. Thread-safe.
GONOGO_HD inline void atomic_min(std::uint64_t& word, std::uint64_t value) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  atomicMin(reinterpret_cast<unsigned long long*>(&word), static_cast<unsigned long long>(value));
#else
  std::uint64_t now = __atomic_load_n(&word, __ATOMIC_RELAXED);
  while (value < now && !__atomic_compare_exchange_n(&word, &now, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

/// Relaxed reads and writes of a word that other threads use at the same time.
GONOGO_HD inline Index load_relaxed(const Index& word) {
#ifdef __CUDA_ARCH__
  return *static_cast<const volatile Index*>(&word);
#else
  return __atomic_load_n(&word, __ATOMIC_RELAXED);
#endif
}
GONOGO_HD inline void store_relaxed(Index& word, Index value) {
#ifdef __CUDA_ARCH__
  *static_cast<volatile Index*>(&word) = value;
#else
  __atomic_store_n(&word, value, __ATOMIC_RELAXED);
#endif
}

/// A count in the memory of the execution space, and its upper bound, which the host knows.
struct Counted {
  Index capacity = 0;
  const Index* count = nullptr;  // in the memory of the execution space
};

/// Scratch memory of scans, kept from call to call.
template <class Exec>
struct ScanScratch {
  Buffer<std::uint8_t, Exec> bytes;
};

/// Below this many indices a second thread costs more time than it saves.
inline constexpr Index kSerialBelow = 512;

template <class Body>
void for_each_index(Cpu exec, Index count, const Body& body, Index serial_below = kSerialBelow) {
  if (exec.threads <= 1 || count < serial_below) {
    for (Index i = 0; i < count; ++i) body(i);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(exec.threads)
  for (Index i = 0; i < count; ++i) body(i);
}

template <class Body>
void for_each_counted(Cpu exec, Counted counted, const Body& body) {
  for_each_index(exec, *counted.count, body);
}

/// out[i] = in[0] + ... + in[i-1] for i = 0..count. `out` has one element more than `in`.
inline void exclusive_scan(Cpu, View<const Index> in, View<Index> out, ScanScratch<Cpu>&) {
  Index sum = 0;
  for (Index i = 0; i < in.size; ++i) {
    const Index value = in[i];
    out[i] = sum;
    sum += value;
  }
  out[in.size] = sum;
}

template <class T>
void clear(Cpu, View<T> items) {
  std::fill(items.begin(), items.end(), T{});
}

#ifdef __CUDACC__
inline constexpr Index kThreadsPerBlock = 128;

template <class Body>
__global__ void run_body(Index count, const Index* halted, Body body) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count || (halted != nullptr && *halted != 0)) return;
  body(i);
}

template <class Body>
__global__ void run_counted(Counted counted, const Index* halted, Body body) {
  const Index i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= counted.capacity || (halted != nullptr && *halted != 0) || i >= *counted.count) return;
  body(i);
}

inline Index blocks_for(Index count) { return (count + kThreadsPerBlock - 1) / kThreadsPerBlock; }
inline cudaStream_t stream_of(Cuda exec) { return static_cast<cudaStream_t>(exec.stream); }

template <class Body>
void for_each_index(Cuda exec, Index count, const Body& body, Index = 0) {
  if (count == 0) return;
  run_body<<<blocks_for(count), kThreadsPerBlock, 0, stream_of(exec)>>>(count, exec.halted, body);
  check_cuda(cudaGetLastError(), "kernel launch");
}

template <class Body>
void for_each_counted(Cuda exec, Counted counted, const Body& body) {
  if (counted.capacity == 0) return;
  run_counted<<<blocks_for(counted.capacity), kThreadsPerBlock, 0, stream_of(exec)>>>(counted, exec.halted, body);
  check_cuda(cudaGetLastError(), "kernel launch");
}

/// The input of a scan with a zero appended, so that the last output is the total.
struct WithZeroAppended {
  View<const Index> in;
  GONOGO_HD Index operator()(Index i) const { return i < in.size ? in[i] : 0; }
};

inline void exclusive_scan(Cuda exec, View<const Index> in, View<Index> out, ScanScratch<Cuda>& scratch) {
  const auto from = thrust::make_transform_iterator(thrust::make_counting_iterator(Index(0)), WithZeroAppended{in});
  std::size_t bytes = 0;
  check_cuda(cub::DeviceScan::ExclusiveSum(nullptr, bytes, from, out.data, in.size + 1, stream_of(exec)), "scan size");
  if (bytes > std::size_t(scratch.bytes.size())) scratch.bytes.resize(bytes);
  check_cuda(cub::DeviceScan::ExclusiveSum(scratch.bytes.data(), bytes, from, out.data, in.size + 1, stream_of(exec)),
             "scan");
}

template <class T>
void clear(Cuda exec, View<T> items) {
  if (items.size > 0) check_cuda(cudaMemsetAsync(items.data, 0, sizeof(T) * items.size, stream_of(exec)), "clear");
}
#endif

/// Runs two independent pieces of work at the same time: on the GPU in two streams, on the host one after the other.
/// Work that follows waits for both. `main` may call this again; `side` may not.
template <class Main, class Side>
void beside(Cpu exec, const Main& main, const Side& side) {
  side(exec);
  main(exec);
}

#ifdef __CUDACC__
/// A second stream, and the events that order it with the first. Copies share it.
class SideStream {
 public:
  SideStream() {
    check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "stream");
    for (cudaEvent_t* event : {&fork_, &join_})
      check_cuda(cudaEventCreateWithFlags(event, cudaEventDisableTiming), "event");
  }
  ~SideStream() {
    cudaEventDestroy(fork_);
    cudaEventDestroy(join_);
    cudaStreamDestroy(stream_);
  }
  SideStream(const SideStream&) = delete;
  SideStream& operator=(const SideStream&) = delete;

  cudaStream_t stream() const { return stream_; }
  void fork(cudaStream_t from) { follow(stream_, from, fork_); }
  void join(cudaStream_t to) { follow(to, stream_, join_); }

 private:
  static void follow(cudaStream_t later, cudaStream_t earlier, cudaEvent_t event) {
    check_cuda(cudaEventRecord(event, earlier), "event");
    check_cuda(cudaStreamWaitEvent(later, event, 0), "event");
  }

  cudaStream_t stream_ = nullptr;
  cudaEvent_t fork_ = nullptr, join_ = nullptr;
};

/// Runs one after the other where there is no side stream.
template <class Main, class Side>
void beside(Cuda exec, const Main& main, const Side& side) {
  if (exec.side_count == 0) {
    side(exec);
    main(exec);
    return;
  }
  SideStream& second = static_cast<SideStream*>(exec.side)[0];
  second.fork(stream_of(exec));
  side(Cuda{second.stream(), exec.halted, nullptr, 0});
  main(Cuda{exec.stream, exec.halted, static_cast<SideStream*>(exec.side) + 1, exec.side_count - 1});
  second.join(stream_of(exec));
}
#endif

/// Exceptions may not leave a parallel loop. This keeps the first one and throws it after the loop.
class FirstError {
 public:
  /// Runs `work` unless a thread has already failed. Thread-safe.
  template <class Work>
  void guard(const Work& work) noexcept {
    if (failed_) return;
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }

  /// Call after the loop.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::exception_ptr error_;
  std::mutex mutex_;
  std::atomic<bool> failed_ = false;
};

/// `threads` where it is positive, otherwise all cores of this machine.
inline int threads_or_all(int threads) {
  return threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace gonogo
