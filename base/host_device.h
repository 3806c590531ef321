// GONOGO_HD marks the formulas that are compiled for the CPU and for CUDA. The only place, with for_each.h and
// buffer.h, that asks which compiler is at work.
#pragma once

#ifdef __CUDACC__
#define GONOGO_HD __host__ __device__
#else
#define GONOGO_HD
#endif
