// Time of SPIKE beside LAPACK's dgbsv on random diagonally dominant banded systems. Not a test: prints a table.
//   spike_speed [n [half...]]
// Both solve one right-hand side in place of their matrix; laying the matrix out for them is not timed. Methods take
// turns, and each time is the median of nine: by the clock, and processor time of the thread that took most. The latter
// also holds on a busy machine; set OMP_WAIT_POLICY=passive, so that threads that wait take none.
#include <omp.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "sim/local_problem/banded/spike.h"
#include "tests/sim/random_band.h"

extern "C" void dgbsv_(const int* n, const int* kl, const int* ku, const int* nrhs, double* ab, const int* ldab,
                       int* ipiv, double* b, const int* ldb, int* info);

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kRounds = 9;

struct Run {
  VectorXd x;
  double clock_ms = 0, processor_ms = 0;
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

struct Method {
  const char* name;
  int threads, partitions;
  SpikeKind kind;
};

Run by_spike(const BandedMatrix<double>& a, const VectorXd& b, const Method& method) {
  omp_set_num_threads(method.threads);
  BandedMatrix<double> copy = a;
  Run run{.x = b};
  const Stopwatch watch(method.threads);
  const Spike<double> spike(std::move(copy), {method.partitions, method.kind});
  if (method.kind == SpikeKind::full)
    spike.solve(run.x);
  else
    run.x = refine(a, spike, b, 1e-12).x;
  watch.stop(run);
  return run;
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

void compare(Index n, Index half) {
  const std::vector<Method> methods = {{"full, 1 thread", 1, 1, SpikeKind::full},
                                       {"full, 1 thread", 1, 2, SpikeKind::full},
                                       {"full, 2 threads", 2, 2, SpikeKind::full},
                                       {"full, 2 threads", 2, 4, SpikeKind::full},
                                       {"truncated, 2 threads", 2, 4, SpikeKind::truncated}};
  const BandedMatrix<double> a = random_band(1, n, half, 1.2);
  const VectorXd b = VectorXd::LinSpaced(n, -1, 2);
  VectorXd reference;
  std::vector<std::vector<double>> clock(methods.size() + 1), processor = clock;
  std::vector<double> off(methods.size() + 1, 0);
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t k = 0; k <= methods.size(); ++k) {
      const Run run = k == 0 ? by_lapack(a, b) : by_spike(a, b, methods[k - 1]);
      if (k == 0) reference = run.x;
      clock[k].push_back(run.clock_ms);
      processor[k].push_back(run.processor_ms);
      off[k] = (run.x - reference).norm() / reference.norm();
    }
  for (std::size_t k = 0; k <= methods.size(); ++k) {
    std::printf("| %ld | %ld | %s | %d | %.1f | %.1f | %.2f | %.0e |\n", long(n), long(half),
                k == 0 ? "dgbsv" : methods[k - 1].name, k == 0 ? 1 : methods[k - 1].partitions, median(clock[k]),
                median(processor[k]), median(processor[k]) / median(processor[0]), off[k]);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Index n = argc > 1 ? std::atol(argv[1]) : 100000;
  std::vector<Index> halves = {5, 10, 20, 50};
  if (argc > 2) halves.clear();
  for (int k = 2; k < argc; ++k) halves.push_back(std::atol(argv[k]));
  std::printf(
      "| n | half | method | partitions | clock ms | processor ms | of dgbsv | off "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const Index half : halves) compare(n, half);
}
