// Marks of functions for the CPU and CUDA:
//   GONOGO_HD           compiled for both
//   GONOGO_HD_INLINED   always inlined, so that many arguments stay in registers
//   GONOGO_HD_OUTLINED  never inlined: long code that should exist once
//   GONOGO_DEVICE       pieces of a kernel. Inlining keeps its parameters in constant memory, since no address is
//   taken.
// Only this file, for_each.h and buffer.h test which compiler is running.
#pragma once
#include <cstddef>
#include <cstring>

/// Before a loop: unrolls it `turns` times on the device, so that its loads overlap.
#ifdef __CUDA_ARCH__
#define GONOGO_PRAGMA(text) _Pragma(#text)
#define GONOGO_UNROLLED(turns) GONOGO_PRAGMA(unroll turns)
#else
#define GONOGO_UNROLLED(turns)
#endif

#ifdef __CUDACC__
#define GONOGO_HD __host__ __device__
#define GONOGO_HD_INLINED __host__ __device__ __forceinline__
#define GONOGO_HD_OUTLINED __host__ __device__ __noinline__ inline
#define GONOGO_DEVICE __device__ __forceinline__
#else
#define GONOGO_HD
#define GONOGO_HD_INLINED inline __attribute__((always_inline))
#define GONOGO_HD_OUTLINED inline __attribute__((noinline))
#endif

namespace gonogo {

/// to = from. On the GPU nvcc 13.0 would store a record from registers byte by byte; this stores words of 16 bytes.
template <class Record>
GONOGO_HD_INLINED void store_words(Record& to, const Record& from) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(Record) % sizeof(int4) == 0 && alignof(Record) % sizeof(int4) == 0);
  int4 word[sizeof(Record) / sizeof(int4)];
  std::memcpy(word, &from, sizeof from);
  for (std::size_t i = 0; i < sizeof(Record) / sizeof(int4); ++i) reinterpret_cast<int4*>(&to)[i] = word[i];
#else
  to = from;
#endif
}

}  // namespace gonogo
