// Four double numbers in one vector register, and their exponentials. They compute in the order of the scalar code, so
// the bits do not depend on the instructions that a processor has.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gonogo {

inline constexpr std::size_t kQuad = 4;
using Quad = double __attribute__((vector_size(kQuad * sizeof(double))));
using QuadBits = std::int64_t __attribute__((vector_size(kQuad * sizeof(double))));

inline Quad load_quad(const double* at) {
  Quad four;
  std::memcpy(&four, at, sizeof four);
  return four;
}
inline void store_quad(const Quad& four, double* at) { std::memcpy(at, &four, sizeof four); }

/// exp(x) within two units in the last place for |x| <= 700; the value at the nearer bound beyond.
inline Quad exponential(Quad x) {
  constexpr double kMost = 700, kPerOctave = 1.4426950408889634074;                        // 1 / ln 2
  constexpr double kHigh = 6.93147180369123816490e-01, kLow = 1.90821492927058770002e-10;  // ln 2 in two parts
  constexpr double kToInteger = 0x1.8p52;  // added, leaves the nearest integer in the last bits
  x = x > kMost ? Quad{} + kMost : x;
  x = x < -kMost ? Quad{} - kMost : x;
  const Quad shifted = x * kPerOctave + kToInteger, octaves = shifted - kToInteger;
  const Quad r = x - octaves * kHigh - octaves * kLow;  // |r| <= ln 2 / 2
  Quad sum = Quad{} + 1.0 / 6227020800;                 // Taylor's series up to r^13 / 13!
  constexpr double kFactor[] = {
      1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720,
      1.0 / 120,       1.0 / 24,       1.0 / 6,       1.0 / 2,      1.0,         1.0};
  for (const double factor : kFactor) sum = sum * r + factor;
  const QuadBits power = ((QuadBits)shifted + 1023) << 52;  // 2^octaves
  return sum * (Quad)power;
}

/// The exponentials of x in place.
inline void take_exponentials(std::span<double> x) {
  std::size_t k = 0;
  for (; k + kQuad <= x.size(); k += kQuad) store_quad(exponential(load_quad(x.data() + k)), x.data() + k);
  if (k == x.size()) return;
  double last[kQuad] = {};
  std::memcpy(last, x.data() + k, (x.size() - k) * sizeof(double));
  store_quad(exponential(load_quad(last)), last);
  std::memcpy(x.data() + k, last, (x.size() - k) * sizeof(double));
}

}  // namespace gonogo
