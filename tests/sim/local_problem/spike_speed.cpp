// Time of SPIKE on the CPU and the GPU beside LAPACK's dgbsv, on random diagonally dominant banded systems. Not a test:
// prints a table.
//   spike_speed [n[,n...] [half...]]
// All solve one right-hand side. Laying the matrix out, and bringing it to the GPU and x back, is not timed. Methods
// take turns, and each time is the median of nine, or of three above n = 200,000: by the clock, and processor time of
// the thread that took most. The latter also holds on a busy machine; set OMP_WAIT_POLICY=passive, so that threads that
// wait take none. Speed-ups take processor time on the CPU and the clock on the GPU. GB/s: the matrix's numbers, in
// double, over that time. Without LAPACK the row of dgbsv is a guess, from the time of SPIKE on one partition and the
// ratio of both that docs/log/contact_solvers.md has.
#include <omp.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <sstream>

#include "base/error.h"
#include "sim/local_problem/banded/spike.h"
#include "sim/local_problem/banded/team_spike.h"
#include "tests/sim/local_problem/random_band.h"

#ifdef GONOGO_WITH_LAPACK
extern "C" void dgbsv_(const int* n, const int* kl, const int* ku, const int* nrhs, double* ab, const int* ldab,
                       int* ipiv, double* b, const int* ldb, int* info);
#endif

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

struct Run {
  VectorXd x;
  double clock_ms = 0, processor_ms = 0;
  double factors_ms = 0;  // by the clock, where they are made for themselves
};

class Stopwatch {
 public:
  explicit Stopwatch(int threads) : processor_(processor_ms(threads)) {}

  void stop(Run& run) const {
    run.clock_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    const std::vector<double> end = processor_ms(int(processor_.size()));
    for (std::size_t k = 0; k < end.size(); ++k) run.processor_ms = std::max(run.processor_ms, end[k] - processor_[k]);
  }

 private:
  /// Of each thread since it began.
  static std::vector<double> processor_ms(int threads) {
    std::vector<double> ms(std::size_t(threads), 0);
#pragma omp parallel num_threads(threads)
    {
      timespec t{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
      ms[std::size_t(omp_get_thread_num())] = 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
    }
    return ms;
  }
  std::vector<double> processor_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

#ifdef GONOGO_WITH_LAPACK
Run by_lapack(const BandedMatrix<double>& a, const VectorXd& b) {
  const int n = int(a.size), half = int(a.half), one = 1, rows = 3 * half + 1;
  std::vector<double> ab(std::size_t(n) * std::size_t(rows), 0.0);
  for (Index i = 0; i < a.size; ++i)
    for (Index j = std::max<Index>(0, i - half); j <= std::min<Index>(n - 1, i + half); ++j)
      ab[std::size_t(j * rows + 2 * half + i - j)] = a.at(i, j);
  std::vector<int> pivot(std::size_t(n), 0);
  Run run{.x = b};
  int info = 0;
  const Stopwatch watch(1);
  dgbsv_(&n, &half, &half, &one, ab.data(), &rows, pivot.data(), run.x.data(), &n, &info);
  watch.stop(run);
  if (info != 0) std::printf("dgbsv: info %d\n", info);
  return run;
}
#endif

/// Of mixed precision and truncated SPIKE.
constexpr double kRefined = 1e-12;

std::string name_of(SpikeKind kind) { return kind == SpikeKind::full ? "full" : "truncated"; }
std::string scalar_name(bool is_single) { return is_single ? "float" : "double"; }

using Solve = std::function<Run(const BandedMatrix<double>&, const VectorXd&)>;
struct Method {
  std::string name, scalar;
  int partitions = 1;
  bool is_on_gpu = false;
  Solve solve;
};

template <class Scalar>
Run by_spike(const BandedMatrix<double>& a, const VectorXd& b, int threads, int partitions, SpikeKind kind) {
  omp_set_num_threads(threads);
  BandedMatrix<double> copy = a;
  Run run{.x = b};
  const Stopwatch watch(threads);
  const Spike<Scalar> spike(std::move(copy), {partitions, kind});
  if constexpr (std::is_same_v<Scalar, double>) {
    if (kind == SpikeKind::full) {
      spike.solve(run.x);
      watch.stop(run);
      return run;
    }
  }
  run.x = refine(a, spike, b, kRefined).x;
  watch.stop(run);
  return run;
}

template <class Scalar>
Method spike_on_cpu(int threads, int partitions, SpikeKind kind) {
  return {
      .name = "CPU SPIKE " + name_of(kind) + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"),
      .scalar = scalar_name(sizeof(Scalar) == 4),
      .partitions = partitions,
      .solve = [=](const auto& a, const auto& b) { return by_spike<Scalar>(a, b, threads, partitions, kind); }};
}

Run by_teams(TeamSpike& spike, const VectorXd& b, bool is_direct) {
  Run run;
  spike.set_right_side({b.begin(), b.end()});
  spike.wait();
  const Stopwatch watch(1);
  spike.factorise();
  if (is_direct)
    spike.solve();
  else
    spike.refine(kRefined);
  spike.wait();
  watch.stop(run);
  const Stopwatch again(1);
  Run factors;
  spike.factorise();
  spike.wait();
  again.stop(factors);
  run.factors_ms = factors.clock_ms;
  const std::vector<double> x = spike.solution();
  run.x = Eigen::Map<const VectorXd>(x.data(), Index(x.size()));
  return run;
}

Method spike_on_gpu(const BandedMatrix<double>& a, const TeamSpikeSettings& settings) {
  const std::shared_ptr<TeamSpike> spike = team_spike_on_gpu(a, settings);
  const bool is_direct = settings.kind == SpikeKind::full && !settings.is_single;
  return {.name = "GPU SPIKE " + name_of(settings.kind),
          .scalar = scalar_name(settings.is_single),
          .partitions = spike->partitions(),
          .is_on_gpu = true,
          .solve = [=](const auto&, const auto& b) { return by_teams(*spike, b, is_direct); }};
}

/// Those of the GPU follow where one answers.
std::vector<Method> methods_for(const BandedMatrix<double>& a) {
  std::vector<Method> list;
#ifdef GONOGO_WITH_LAPACK
  list.push_back({.name = "dgbsv, 1 thread", .scalar = "double", .solve = by_lapack});
#endif
  list.push_back(spike_on_cpu<double>(1, 1, SpikeKind::full));
  list.push_back(spike_on_cpu<double>(1, 2, SpikeKind::full));
  list.push_back(spike_on_cpu<double>(2, 2, SpikeKind::full));
  list.push_back(spike_on_cpu<float>(2, 2, SpikeKind::full));
  list.push_back(spike_on_cpu<double>(2, 4, SpikeKind::full));
  list.push_back(spike_on_cpu<double>(2, 4, SpikeKind::truncated));
  try {
    list.push_back(spike_on_gpu(a, {}));
    const int chosen = list.back().partitions;
    for (const int count : {chosen / 4, chosen / 2, 2 * chosen}) list.push_back(spike_on_gpu(a, {.partitions = count}));
    for (const bool is_single : {false, true}) {
      if (is_single) list.push_back(spike_on_gpu(a, {.is_single = true}));
      list.push_back(spike_on_gpu(a, {.kind = SpikeKind::truncated, .is_single = is_single}));
    }
  } catch (const gonogo::InputError& no_gpu) {
    std::fprintf(stderr, "%s\n", no_gpu.what());
  }
  return list;
}

/// Processor time of dgbsv over that of SPIKE on one partition, from docs/log/contact_solvers.md.
[[maybe_unused]] double known_ratio(Index half) {
  const double ratio = half < 8 ? 0.77 : half < 15 ? 0.60 : half < 35 ? 0.48 : 0.35;
  return 1 / ratio;
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

struct Times {
  std::vector<double> clock, processor, factors;
  VectorXd x;
};

void compare(Index n, Index half) {
  const BandedMatrix<double> a = random_band(1, n, half, 1.2);
  const VectorXd b = VectorXd::LinSpaced(n, -1, 2);
  const std::vector<Method> methods = methods_for(a);
  std::vector<Times> times(methods.size());
  for (int round = -1; round < (n > 200000 ? 3 : 9); ++round)  // the first one warms up
    for (std::size_t k = 0; k < methods.size(); ++k) {
      const Run run = methods[k].solve(a, b);
      times[k].x = run.x;
      if (round < 0) continue;
      times[k].clock.push_back(run.clock_ms);
      times[k].processor.push_back(run.processor_ms);
      times[k].factors.push_back(run.factors_ms);
    }
  double lapack_ms = median(times[0].processor);
  const double band_bytes = double(a.value.size()) * sizeof(double);
#ifndef GONOGO_WITH_LAPACK
  lapack_ms *= known_ratio(half);
  std::printf("| %ld | %ld | dgbsv, guessed | double | 1 | | %.2f | | 1.0 | | %.1f |\n", long(n), long(half), lapack_ms,
              1e-6 * band_bytes / lapack_ms);
#endif
  for (std::size_t k = 0; k < methods.size(); ++k) {
    const Method& method = methods[k];
    const double ms = median(method.is_on_gpu ? times[k].clock : times[k].processor);
    const double factors_ms = median(times[k].factors);
    std::printf("| %ld | %ld | %s | %s | %d | %.2f | %.2f | ", long(n), long(half), method.name.c_str(),
                method.scalar.c_str(), method.partitions, median(times[k].clock), median(times[k].processor));
    if (factors_ms > 0) std::printf("%.2f", factors_ms);
    std::printf(" | %.1f | %.0e | %.1f |\n", lapack_ms / ms, (b - product(a, times[k].x)).norm() / b.norm(),
                1e-6 * band_bytes / ms);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Index> sizes, halves;
  std::stringstream list(argc > 1 ? argv[1] : "100000,1000000");
  for (std::string size; std::getline(list, size, ',');) sizes.push_back(std::atol(size.c_str()));
  for (int k = 2; k < argc; ++k) halves.push_back(std::atol(argv[k]));
  if (halves.empty()) halves = {5, 10, 20, 50};
  std::printf(
      "| n | half | method | factors | partitions | clock ms | processor ms | factors alone ms | times as fast as "
      "dgbsv "
      "| residual | GB/s |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Index n : sizes)
    for (const Index half : halves) compare(n, half);
}
