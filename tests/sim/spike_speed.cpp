// Time of SPIKE beside LAPACK's dgbsv on random diagonally dominant banded systems. Not a test: prints a table.
//   spike_speed [n [half...]]
// Both solve one right-hand side in place of their matrix; laying the matrix out for them is not timed. Methods take
// turns, and each time is the median of nine.
#include <omp.h>

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
  double ms = 0;
};

class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
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
  const Stopwatch watch;
  dgbsv_(&n, &half, &half, &one, ab.data(), &rows, pivot.data(), run.x.data(), &n, &info);
  run.ms = watch.ms();
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
  const Stopwatch watch;
  const Spike<double> spike(std::move(copy), {method.partitions, method.kind});
  if (method.kind == SpikeKind::full)
    spike.solve(run.x);
  else
    run.x = refine(a, spike, b, 1e-12).x;
  run.ms = watch.ms();
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
  std::vector<double> lapack;
  std::vector<std::vector<double>> times(methods.size());
  std::vector<double> off(methods.size());
  for (int round = 0; round < kRounds; ++round) {
    Run run = by_lapack(a, b);
    lapack.push_back(run.ms);
    reference = run.x;
    for (std::size_t k = 0; k < methods.size(); ++k) {
      run = by_spike(a, b, methods[k]);
      times[k].push_back(run.ms);
      off[k] = (run.x - reference).norm() / reference.norm();
    }
  }
  const double standard = median(lapack);
  std::printf("| %ld | %ld | dgbsv | - | %.1f | 1 | - |\n", long(n), long(half), standard);
  for (std::size_t k = 0; k < methods.size(); ++k)
    std::printf("| %ld | %ld | %s | %d | %.1f | %.2f | %.0e |\n", long(n), long(half), methods[k].name,
                methods[k].partitions, median(times[k]), median(times[k]) / standard, off[k]);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Index n = argc > 1 ? std::atol(argv[1]) : 100000;
  std::vector<Index> halves = {5, 10, 20, 50};
  if (argc > 2) halves.clear();
  for (int k = 2; k < argc; ++k) halves.push_back(std::atol(argv[k]));
  std::printf("| n | half | method | partitions | ms | of dgbsv | off |\n|---|---|---|---|---|---|---|\n");
  for (const Index half : halves) compare(n, half);
}
