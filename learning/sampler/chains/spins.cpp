#include "learning/sampler/chains/spins.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {

SpinGraph::SpinGraph(const Problem& ising) : h(ising.linear), first(ising.variable_count() + 1, 0) {
  GONOGO_ASSERT(ising.vartype == Vartype::spin);
  for (const Coupling& c : ising.couplings) {
    ++first[c.a + 1];
    ++first[c.b + 1];
  }
  for (std::size_t i = 0; i < h.size(); ++i) first[i + 1] += first[i];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  neighbour.resize(2 * ising.couplings.size());
  J.resize(neighbour.size());
  for (const Coupling& c : ising.couplings) {
    neighbour[next[c.a]] = c.b;
    J[next[c.a]++] = c.value;
    neighbour[next[c.b]] = c.a;
    J[next[c.b]++] = c.value;
  }
}

void Spins::randomise(ChainRandom& random) {
  for (std::size_t i = 0; i < s_.size(); ++i) s_[i] = random(i) < 0.5 ? 1 : -1;
  refresh();
}

void Spins::refresh() {
  field_ = graph_->h;
  for (std::uint32_t i = 0; i < s_.size(); ++i)
    for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
      field_[i] += graph_->J[k] * s_[graph_->neighbour[k]];
}

void Spins::flip(std::uint32_t i) {
  s_[i] = std::int8_t(-s_[i]);
  for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
    field_[graph_->neighbour[k]] += 2 * graph_->J[k] * s_[i];
}

void Spins::sweep(double beta, ChainRandom& random) {
  constexpr double certain = 25;  // exp(-25) is below the resolution of the draws
  for (std::uint32_t i = 0; i < s_.size(); ++i) {
    const double x = 2 * beta * field_[i];
    const bool up = x > certain ? false : x < -certain ? true : random(i) * (1 + std::exp(x)) < 1;
    if (up != (s_[i] > 0)) flip(i);
  }
}

double Spins::energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < s_.size(); ++i) sum += s_[i] * (field_[i] + graph_->h[i]) / 2;
  return sum;
}

SampleSet empty_rows(const Problem& problem, std::size_t reads) {
  SampleSet rows{.vartype = problem.vartype, .labels = problem.labels};
  rows.values.resize(reads * problem.variable_count());
  rows.energies.resize(reads);
  rows.occurrences.assign(reads, 1);
  return rows;
}

void set_row(SampleSet& rows, std::size_t r, const Problem& problem, std::span<const std::int8_t> spins) {
  const std::size_t n = problem.variable_count();
  const auto row = std::span(rows.values).subspan(r * n, n);
  for (std::size_t i = 0; i < n; ++i) row[i] = problem.vartype == Vartype::spin ? spins[i] : std::int8_t(spins[i] > 0);
  rows.energies[r] = energy(problem, row);
}

namespace {

using Floats = Lanes<float>;
using Words = Lanes<std::uint32_t>;
using Signed = Lanes<std::int32_t>;
using Pairs = std::uint64_t __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

constexpr float kCertain = 22.5f;  // exp(-22.5) is below the smallest draw, 2^-32

/// exp(x) for |x| <= 80 to 3e-7: 2^n exp(r), x = n log 2 + r, by Taylor's series on |r| <= log(2) / 2.
inline Floats exponential(const Floats& x) {
  const Signed n = __builtin_convertvector(x * 1.44269504f + 127.5f, Signed);  // positive, so truncation rounds down
  const Floats whole = __builtin_convertvector(n - 127, Floats);
  const Floats r = (x - whole * 0.693359375f) + whole * 2.12194440e-4f;  // log 2 in two parts
  Floats p = r * (1.0f / 720) + 1.0f / 120;
  p = p * r + 1.0f / 24;
  p = p * r + 1.0f / 6;
  p = p * r + 0.5f;
  p = p * r * r + r + 1;
  return p * Floats(n << 23);  // the bits of n make the float 2^(n - 127)
}

/// Uniform in (0, 1].
inline Floats unit(const Words& words) {
  return (__builtin_convertvector(Signed(words >> 1), Floats) + 0.5f) * 0x1.0p-31f;
}

inline bool any(const Signed& mask) {
#ifdef __AVX2__
  return !_mm256_testz_si256(__m256i(mask), __m256i(mask));
#else
  const auto pairs = Pairs(mask);
  return (pairs[0] | pairs[1] | pairs[2] | pairs[3]) != 0;
#endif
}

/// Products of the low halves of four numbers, 64 bits each: one instruction, which compilers do not find by
/// themselves.
inline Pairs low_products(const Pairs& x, std::uint32_t factor) {
#ifdef __AVX2__
  return Pairs(_mm256_mul_epu32(__m256i(x), _mm256_set1_epi64x(factor)));
#else
  return (x & 0xFFFFFFFFu) * factor;
#endif
}

/// philox() of base/math/random.h on the counters of four chains; only the low halves of the numbers count.
inline void philox(Pairs (&word)[4], const PhiloxKeys& keys) {
  for (const auto& key : keys.round) {
    const Pairs product0 = low_products(word[0], 0xD2511F53u), product1 = low_products(word[2], 0xCD9E8D57u);
    word[0] = (product1 >> 32) ^ word[1] ^ std::uint64_t(key[0]);
    word[1] = product1;
    word[2] = (product0 >> 32) ^ word[3] ^ std::uint64_t(key[1]);
    word[3] = product0;
  }
}

}  // namespace

LaneRandom::LaneRandom(std::uint64_t seed, std::uint64_t first_chain, std::size_t units_per_row)
    : keys_(seed), first_chain_(first_chain), blocks_per_row_((units_per_row + 3) / 4) {}

void LaneRandom::begin(std::uint64_t row) {
  row_ = row * blocks_per_row_;
  held_ = UINT64_MAX;
}

void LaneRandom::draw(std::uint64_t index) {
  const Pairs counter = Pairs{} + index, chain = Pairs{0, 2, 4, 6} + first_chain_;
  Pairs even[4] = {counter, counter >> 32, chain, chain >> 32},
        odd[4] = {even[0], even[1], chain + 1, (chain + 1) >> 32};
  philox(even, keys_);
  philox(odd, keys_);
  for (int w = 0; w < 4; ++w) word_[w] = Words((even[w] & 0xFFFFFFFFu) | odd[w] << 32);
  held_ = index;
}

template <class Real>
SpinLanes<Real>::SpinLanes(const SpinGraph& graph)
    : graph_(&graph),
      h_(graph.h.begin(), graph.h.end()),
      J_(graph.J.begin(), graph.J.end()),
      s_(graph.size()),
      field_(graph.size()) {
  for (Row& row : s_) row.of = Lanes<Real>{} + Real(1);
  refresh();
}

template <class Real>
void SpinLanes<Real>::randomise(LaneRandom& random) {
  for (std::size_t i = 0; i < s_.size(); ++i) {
    const Words& words = random(i);
    for (int l = 0; l < kLanes; ++l) s_[i].of[l] = words[l] < 0x80000000u ? 1 : -1;
  }
  refresh();
}

template <class Real>
void SpinLanes<Real>::refresh() {
  for (std::uint32_t i = 0; i < s_.size(); ++i) {
    Lanes<Real> sum = Lanes<Real>{} + h_[i];
    for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k) sum += J_[k] * s_[graph_->neighbour[k]].of;
    field_[i].of = sum;
  }
}

template <class Real>
void SpinLanes<Real>::sweep(double beta, TurnRule rule, LaneRandom& random) {
  const float against = rule == TurnRule::heat_bath ? 1 : 0;
  const Real twice = Real(-2 * beta);
  for (std::uint32_t i = 0; i < s_.size(); ++i) {
    const Lanes<Real> s = s_[i].of;
    const Floats x = __builtin_convertvector(twice * s * field_[i].of, Floats);  // beta dE
    const Signed open = x < kCertain;
    if (!any(open)) continue;
    const Floats inside = x > -kCertain ? x : Floats{} - kCertain;  // what exp says above kCertain does not count
    const Signed turns = open & (unit(random(i)) * (against + exponential(inside)) < 1);
    if (!any(turns)) continue;
    const Lanes<Real> change = -2 * s * -__builtin_convertvector(turns, Lanes<Real>);  // true is -1
    s_[i].of = s + change;
    for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
      field_[graph_->neighbour[k]].of += J_[k] * change;
  }
}

template <class Real>
void SpinLanes<Real>::read(int lane, std::span<std::int8_t> spins) const {
  for (std::size_t i = 0; i < s_.size(); ++i) spins[i] = s_[i].of[lane] > 0 ? 1 : -1;
}

template class SpinLanes<float>;
template class SpinLanes<double>;

bool single_precision_holds(const SpinGraph& graph, double beta) {
  double largest = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    double sum = std::abs(graph.h[i]);
    for (std::uint32_t k = graph.first[i]; k < graph.first[i + 1]; ++k) sum += std::abs(graph.J[k]);
    largest = std::max(largest, sum);
  }
  return 2 * beta * largest * 0x1.0p-24 < 1e-4;
}

}  // namespace gonogo::learning
