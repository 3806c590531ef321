// Eight numbers in one vector register: a formula template runs on eight contacts at once on the host.
// Each lane computes in the order of the scalar code, so both give the same bits. With one lane (Real) the same
// template serves the GPU.
#pragma once
#include "base/math/vec.h"

#ifdef __AVX__
#include <immintrin.h>
#endif

namespace gonogo {

// One lane.
GONOGO_HD inline Real select(bool condition, Real yes, Real no) { return condition ? yes : no; }
GONOGO_HD inline bool both(bool a, bool b) { return a && b; }
GONOGO_HD inline bool either(bool a, bool b) { return a || b; }
GONOGO_HD inline Real square_root(Real x) { return std::sqrt(x); }

/// Correctly rounded on the host. On the GPU a faster version, exact to a few units in the last place.
GONOGO_HD inline Real quick_root(Real x) {
#ifdef __CUDA_ARCH__
  Real root;
  asm("sqrt.approx.f32 %0, %1;" : "=f"(root) : "f"(x));
  return root;
#else
  return std::sqrt(x);
#endif
}
GONOGO_HD inline Real quick_ratio(Real a, Real b) {
#ifdef __CUDA_ARCH__
  return __fdividef(a, b);
#else
  return a / b;
#endif
}
/// Whether a branch may be left out because no lane takes it. Never with one lane: on a GPU the neighbouring threads
/// may take it.
GONOGO_HD inline bool no_lane(bool) { return false; }
template <class T>
GONOGO_HD inline T constant(Real x);
template <>
GONOGO_HD inline Real constant<Real>(Real x) {
  return x;
}

#ifndef __CUDACC__
inline constexpr int kPackWidth = 8;
using Pack = Real __attribute__((vector_size(4 * kPackWidth)));
using PackMask = std::int32_t __attribute__((vector_size(4 * kPackWidth)));

/// Eight consecutive numbers of any record. The type may alias others, so loads and stores are well defined.
using PackInMemory = Real __attribute__((vector_size(4 * kPackWidth), may_alias));

inline Pack select(PackMask condition, Pack yes, Pack no) { return condition ? yes : no; }
inline PackMask both(PackMask a, PackMask b) { return a & b; }
inline PackMask either(PackMask a, PackMask b) { return a | b; }
inline bool no_lane(PackMask condition) {
#ifdef __AVX__
  return _mm256_testz_si256(__m256i(condition), __m256i(condition));
#else
  for (int lane = 0; lane < kPackWidth; ++lane)
    if (condition[lane]) return false;
  return true;
#endif
}
template <>
inline Pack constant<Pack>(Real x) {
  return Pack{} + x;
}

inline Pack square_root(Pack x) {
#ifdef __AVX__
  return _mm256_sqrt_ps(x);
#else
  Pack y;
  for (int lane = 0; lane < kPackWidth; ++lane) y[lane] = std::sqrt(x[lane]);
  return y;
#endif
}

inline Pack quick_root(Pack x) { return square_root(x); }
inline Pack quick_ratio(Pack a, Pack b) { return a / b; }

/// Transposes 8 x 8 numbers: eight records of 32 bytes to one pack per field, and back.
inline void transpose(Pack (&m)[kPackWidth]) {
#ifdef __AVX__
  const __m256 t0 = _mm256_unpacklo_ps(m[0], m[1]), t1 = _mm256_unpackhi_ps(m[0], m[1]);
  const __m256 t2 = _mm256_unpacklo_ps(m[2], m[3]), t3 = _mm256_unpackhi_ps(m[2], m[3]);
  const __m256 t4 = _mm256_unpacklo_ps(m[4], m[5]), t5 = _mm256_unpackhi_ps(m[4], m[5]);
  const __m256 t6 = _mm256_unpacklo_ps(m[6], m[7]), t7 = _mm256_unpackhi_ps(m[6], m[7]);
  const __m256 s0 = _mm256_shuffle_ps(t0, t2, 0x44), s1 = _mm256_shuffle_ps(t0, t2, 0xEE);
  const __m256 s2 = _mm256_shuffle_ps(t1, t3, 0x44), s3 = _mm256_shuffle_ps(t1, t3, 0xEE);
  const __m256 s4 = _mm256_shuffle_ps(t4, t6, 0x44), s5 = _mm256_shuffle_ps(t4, t6, 0xEE);
  const __m256 s6 = _mm256_shuffle_ps(t5, t7, 0x44), s7 = _mm256_shuffle_ps(t5, t7, 0xEE);
  m[0] = _mm256_permute2f128_ps(s0, s4, 0x20);
  m[4] = _mm256_permute2f128_ps(s0, s4, 0x31);
  m[1] = _mm256_permute2f128_ps(s1, s5, 0x20);
  m[5] = _mm256_permute2f128_ps(s1, s5, 0x31);
  m[2] = _mm256_permute2f128_ps(s2, s6, 0x20);
  m[6] = _mm256_permute2f128_ps(s2, s6, 0x31);
  m[3] = _mm256_permute2f128_ps(s3, s7, 0x20);
  m[7] = _mm256_permute2f128_ps(s3, s7, 0x31);
#else
  for (int i = 0; i < kPackWidth; ++i)
    for (int j = i + 1; j < kPackWidth; ++j) {
      const Real x = m[i][j];
      m[i][j] = m[j][i];
      m[j][i] = x;
    }
#endif
}
#endif

}  // namespace gonogo
