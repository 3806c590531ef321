// GONOGO_HD_INLINED is for formulas whose many arguments must stay in registers. GONOGO_HD marks the formulas that are
// compiled for the CPU and for CUDA. The only place, with for_each.h and buffer.h, that asks which compiler is at work.
#pragma once

#ifdef __CUDACC__
#define GONOGO_HD __host__ __device__
#define GONOGO_HD_INLINED __host__ __device__ __forceinline__
#else
#define GONOGO_HD
#define GONOGO_HD_INLINED inline __attribute__((always_inline))
#endif
