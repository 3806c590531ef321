// GONOGO_HD marks the formulas that are compiled for the CPU and for CUDA; GONOGO_HD_INLINED is for those whose many
// arguments must stay in registers, GONOGO_HD_OUTLINED for long code that must be there once only, GONOGO_DEVICE for
// the parts of a kernel, whose parameters are read from constant memory only as long as nothing holds their address.
// The only place, with for_each.h and buffer.h, that asks which compiler is at work.
#pragma once

/// Before a loop: so many turns are written out on the device, whose loads are then under way together.
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
