// Numbers side by side in one vector register of 32 bytes.
#pragma once
#include <cstring>

#include <Eigen/Core>

#ifdef __FMA__
#include <immintrin.h>
#endif

namespace gonogo::sim {

template <class Scalar>
struct Lanes {
  static constexpr Eigen::Index kWidth = 32 / Eigen::Index(sizeof(Scalar));
  typedef Scalar Pack __attribute__((vector_size(32)));

  static Pack load(const Scalar* from) {
    Pack p;
    std::memcpy(&p, from, sizeof p);
    return p;
  }
  static void store(Scalar* to, Pack p) { std::memcpy(to, &p, sizeof p); }
  static Pack fill(Scalar x) { return Pack{} + x; }

  /// a b + c, rounded once where the processor fuses them.
  static Pack multiply_add(Pack a, Pack b, Pack c) {
#ifdef __FMA__
    if constexpr (sizeof(Scalar) == 8)
      return _mm256_fmadd_pd(a, b, c);
    else
      return _mm256_fmadd_ps(a, b, c);
#else
    return a * b + c;
#endif
  }

  /// By halves.
  static Scalar sum(Pack p) {
    Scalar part[kWidth];
    store(part, p);
    for (Eigen::Index half = kWidth / 2; half > 0; half /= 2)
      for (Eigen::Index k = 0; k < half; ++k) part[k] += part[k + half];
    return part[0];
  }
};

}  // namespace gonogo::sim
