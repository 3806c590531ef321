// How a matrix is cut, and the order in which teams work on it; see team_spike.h. Included by the file of each backend.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/local_problem/banded/team_joint.h"
#include "sim/local_problem/banded/team_partition.h"
#include "sim/local_problem/banded/team_spike.h"

namespace gonogo::sim {

/// to = from times a power of two that brings it into the range of float.
template <class Scalar>
struct ScaleInto {
  View<const double> from;
  View<Scalar> to;
  double scale;

  GONOGO_HD void operator()(Index i) const { to[i] = Scalar(scale * from[i]); }
};

/// sum = x + scale step.
template <class Scalar>
struct AddStep {
  View<const double> x;
  View<const Scalar> step;
  View<double> sum;
  double scale;

  GONOGO_HD void operator()(Index i) const { sum[i] = std::fma(scale, double(step[i]), x[i]); }
};

/// Rows of which one team takes the residual.
inline constexpr Index kResidualRows = 64;

/// rest = b - A x, and of each team's rows the sum of squares and the largest size.
struct FindResidual {
  Index size, half;
  View<const double> a, b, x;
  View<double> rest, sums;  // sums: [teams][2]

  Index teams() const { return (size + kResidualRows - 1) / kResidualRows; }
  TeamShape shape() const {
    const Index numbers = kResidualRows * (2 * half + 1) + 2 * kResidualRows + 2 * half;
    return grid_for(half, 128, std::size_t(numbers) * sizeof(double));
  }
  template <class Team>
  GONOGO_HD void operator()(Team team, Index tile, double* room) const {
    const Index width = 2 * half + 1, first = tile * kResidualRows;
    const Index rows = size - first < kResidualRows ? size - first : kResidualRows;
    double *const near = room + kResidualRows * width, *const own = near + kResidualRows + 2 * half;
    for (Index q = team.rank(); q < rows * width; q += team.size()) room[q] = a[first * width + q];
    for (Index q = team.rank(); q < rows + 2 * half; q += team.size()) {
      const Index j = first - half + q;
      near[q] = j >= 0 && j < size ? x[j] : 0.0;
    }
    team.sync();
    for (Index i = team.rank(); i < rows; i += team.size()) {
      double sum = b[first + i];
      for (Index q = 0; q < width; ++q) sum = std::fma(-room[i * width + q], near[i + q], sum);
      rest[first + i] = own[i] = sum;
    }
    team.sync();
    if (team.rank() != 0) return;
    double square = 0, largest = 0;
    for (Index i = 0; i < rows; ++i) {
      square = std::fma(own[i], own[i], square);
      largest = std::fmax(largest, std::fabs(own[i]));
    }
    sums[2 * tile] = square;
    sums[2 * tile + 1] = largest;
  }
};

struct TeamSpikePlan {
  SpikeKind kind = SpikeKind::full;
  Partitions all;
  std::vector<PairsOfNodes> levels{};  // partitions are nodes 0, 1, ...; truncated: one level; none for one partition
  Index nodes = 0, joints = 0;
  double largest = 0;  // on the diagonal
};

/// InputError where the matrix has 2^31 numbers or more.
TeamSpikePlan plan_team_spike(const BandedMatrix<double>& a, const TeamSpikeSettings& settings);

/// For programs with CUDA.
std::unique_ptr<TeamSpike> make_team_spike_on_gpu(const TeamSpikePlan& plan, const std::vector<double>& a,
                                                  bool is_single);

/// Wait: what a caller does before it reads what teams wrote.
template <class Exec, class Scalar, class Wait>
class TeamSpikeOn final : public TeamSpike {
 public:
  TeamSpikeOn(Exec exec, const TeamSpikePlan& plan, const std::vector<double>& a, Wait wait)
      : exec_(exec), wait_(wait), is_full_(plan.kind == SpikeKind::full), all_(plan.all), levels_(plan.levels) {
    const std::size_t n = std::size_t(all_.size), k = std::size_t(all_.half), p = std::size_t(all_.count);
    const std::size_t nodes = std::size_t(plan.nodes), joints = std::size_t(plan.joints);
    a_.upload(a);
    factor_.resize(n * (2 * k + 1));
    if (p > 1) {
      if (is_full_) swept_.resize(n * k);
      if (!is_full_) corner_.resize(p * k * (2 * k + 1));
      tips_.fill_zero(nodes * 4 * k * k);
      inverse_.resize(joints * k * k);
      if (is_full_) response_.resize(joints * 2 * k * k);
      ends_.resize(nodes * 2 * k);
      outer_.fill_zero(nodes * 2 * k);
      middle_.resize(joints * 2 * k);
    }
    for (Buffer<Scalar, Exec>* v : {&right_, &step_}) v->resize(n);
    for (Buffer<double, Exec>* v : {&b_, &x_, &tried_, &rest_}) v->resize(n);
    sums_.resize(2 * std::size_t(residual().teams()));
    boosted_.fill_zero(1);
    least_ =
        std::max(Scalar(plan.largest) * std::numeric_limits<Scalar>::epsilon(), std::numeric_limits<Scalar>::min());
  }

  void factorise() override {
    boosted_.fill_zero(1);
    const bool is_split = all_.count > 1;
    const FactorRows<Scalar> down{factor_.view(), false}, up{corner_.view(), true};
    const View<Scalar> swept = is_split ? swept_.view() : View<Scalar>{};
    run(all_.count, FactorisePartition<Scalar>{all_, a_.view(), down, swept, boosted_.view(), least_});
    if (!is_split) return;
    run(all_.count, FindTips<Scalar>{all_, down, swept, tips_.view()});
    if (!is_full_) {
      run(all_.count, FactorisePartition<Scalar>{all_, a_.view(), up, {}, boosted_.view(), least_});
      run(all_.count, FindTips<Scalar>{all_, up, {}, tips_.view()});
    }
    const Scalar least = std::numeric_limits<Scalar>::epsilon();
    for (const PairsOfNodes& pairs : levels_)
      run(pairs.count(), JoinPair<Scalar>{all_.half, pairs, tips_.view(), joints(), boosted_.view(), least});
  }

  void set_right_side(const std::vector<double>& b) override {
    GONOGO_ASSERT(Index(b.size()) == all_.size);
    b_.upload(b);
    norm_ = largest_ = 0;
    for (const double value : b) {
      norm_ += value * value;
      largest_ = std::max(largest_, std::fabs(value));
    }
    norm_ = std::sqrt(norm_);
  }

  void solve() override {
    x_.fill_zero(std::size_t(all_.size));
    step_from(b_.view(), largest_);
    x_.swap(tried_);
  }

  Refined refine(double tolerance, int max) override {
    Refined best{.residual = 1, .iterations = 0};
    x_.fill_zero(std::size_t(all_.size));
    double largest = largest_;
    while (best.iterations < max && norm_ > 0 && best.residual > tolerance) {
      step_from(best.iterations == 0 ? b_.view() : rest_.view(), largest);
      ++best.iterations;
      const double found = measure(largest);
      if (!(found < best.residual)) break;
      const bool halves = found < best.residual / 2;
      best.residual = found;
      x_.swap(tried_);
      if (!halves) break;
    }
    return best;
  }

  void wait() override { wait_(); }
  std::vector<double> solution() override {
    wait_();
    return x_.download();
  }
  int partitions() const override { return all_.count; }
  int boosted() override {
    wait_();
    return boosted_.read(0);
  }
  std::size_t bytes() const override {
    std::size_t numbers = 0;
    for (const Buffer<Scalar, Exec>* v : {&factor_, &swept_, &corner_, &tips_, &inverse_, &response_})
      numbers += std::size_t(v->size());
    return numbers * sizeof(Scalar);
  }

 private:
  template <class Body>
  void run(Index teams, const Body& body) {
    for_each_team(exec_, teams, body.shape(), body);
  }
  Joints<Scalar> joints() { return {inverse_.view(), response_.view()}; }
  FindResidual residual() {
    return {all_.size, all_.half, a_.view(), b_.view(), tried_.view(), rest_.view(), sums_.view()};
  }

  /// tried = x + A^-1 rest, where |rest| is at most `largest`.
  void step_from(View<const double> rest, double largest) {
    const double scale = std::ldexp(1.0, largest > 0 ? -std::ilogb(largest) : 0);
    for_each_index(exec_, all_.size, ScaleInto<Scalar>{rest, right_.view(), scale});
    solve_step();
    for_each_index(exec_, all_.size, AddStep<Scalar>{x_.view(), step_.view(), tried_.view(), 1 / scale});
  }

  /// step = A^-1 right.
  void solve_step() {
    const SolvePartition<Scalar> alone{all_, a_.view(), factor_.view(), right_.view(), {}, step_.view()};
    run(all_.count, alone);
    if (all_.count == 1 || all_.half == 0) return;
    for_each_index(exec_, 2 * all_.half * all_.count, TakeEnds<Scalar>{all_, step_.view(), ends_.view()});
    const Index k = all_.half;
    for (const PairsOfNodes& pairs : levels_)
      run(pairs.count(),
          JoinEnds<Scalar>{k, pairs, tips_.view(), joints(), ends_.view(), middle_.view(), outer_.view()});
    for (std::size_t level = is_full_ ? levels_.size() : 0; level-- > 0;)
      run(levels_[level].count(),
          SplitOuter<Scalar>{k, levels_[level], tips_.view(), joints(), middle_.view(), outer_.view()});
    SolvePartition<Scalar> among = alone;
    among.outer = outer_.view();
    run(all_.count, among);
  }

  /// |b - A tried| / |b|, its largest number into `largest`. Sums of teams are added in their order.
  double measure(double& largest) {
    const FindResidual body = residual();
    run(body.teams(), body);
    wait_();
    const std::vector<double> sums = sums_.download();
    double square = 0;
    largest = 0;
    for (std::size_t t = 0; t < sums.size(); t += 2) {
      square += sums[t];
      largest = std::max(largest, sums[t + 1]);
    }
    return std::sqrt(square) / norm_;
  }

  Exec exec_;
  Wait wait_;
  bool is_full_;
  Partitions all_;
  std::vector<PairsOfNodes> levels_;
  Buffer<double, Exec> a_;
  Buffer<Scalar, Exec> factor_, swept_, corner_, tips_, inverse_, response_, ends_, middle_, outer_, right_, step_;
  Buffer<double, Exec> b_, x_, tried_, rest_, sums_;
  Buffer<Index, Exec> boosted_;
  Scalar least_ = 0;
  double norm_ = 0, largest_ = 0;
};

/// Factors in double or float.
template <class Exec, class Wait>
std::unique_ptr<TeamSpike> make_team_spike(Exec exec, const TeamSpikePlan& plan, const std::vector<double>& a,
                                           bool is_single, Wait wait) {
  if (is_single) return std::make_unique<TeamSpikeOn<Exec, float, Wait>>(exec, plan, a, wait);
  return std::make_unique<TeamSpikeOn<Exec, double, Wait>>(exec, plan, a, wait);
}

}  // namespace gonogo::sim
