// Time of SPIKE beside LAPACK's dgbsv on random diagonally dominant banded systems. Not a test: prints a table.
//   spike_speed [n [half...]]
#include <omp.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "sim/local_problem/banded/spike.h"
#include "tests/sim/random_band.h"

extern "C" void dgbsv_(const int* n, const int* kl, const int* ku, const int* nrhs, double* ab, const int* ldab,
                       int* ipiv, double* b, const int* ldb, int* info);

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Shortest of three runs [ms].
double time_ms(const std::function<void()>& run) {
  double best = 1e300;
  for (int k = 0; k < 3; ++k) {
    const auto start = std::chrono::steady_clock::now();
    run();
    best = std::min(best, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

VectorXd by_lapack(const BandedMatrix<double>& a, const VectorXd& b) {
  const int n = int(a.size), half = int(a.half), one = 1, rows = 3 * half + 1;
  std::vector<double> ab(std::size_t(n) * std::size_t(rows), 0.0);
  for (Index i = 0; i < a.size; ++i)
    for (Index j = std::max<Index>(0, i - half); j <= std::min<Index>(n - 1, i + half); ++j)
      ab[std::size_t(j * rows + 2 * half + i - j)] = a.at(i, j);
  std::vector<int> pivot(std::size_t(n), 0);
  VectorXd x = b;
  int info = 0;
  dgbsv_(&n, &half, &half, &one, ab.data(), &rows, pivot.data(), x.data(), &n, &info);
  if (info != 0) std::printf("dgbsv: info %d\n", info);
  return x;
}

void compare(Index n, Index half) {
  const BandedMatrix<double> a = random_band(1, n, half, 1.2);
  const VectorXd b = VectorXd::LinSpaced(n, -1, 2);
  VectorXd reference;
  const double lapack = time_ms([&] { reference = by_lapack(a, b); });
  std::printf("n %ld half %ld  dgbsv %.1f ms\n", long(n), long(half), lapack);
  const int threads = omp_get_max_threads();
  for (const int count : {1, threads}) {
    omp_set_num_threads(count);
    for (const auto& [kind, partitions] :
         {std::pair{SpikeKind::full, 1}, {SpikeKind::full, count}, {SpikeKind::truncated, 4}}) {
      VectorXd x;
      const double ms = time_ms([&] {
        const Spike<double> spike(a, {partitions, kind});
        x = kind == SpikeKind::full ? b : refine(a, spike, b, 1e-12).x;
        if (kind == SpikeKind::full) spike.solve(x);
      });
      std::printf("  %-9s P %d, %d threads: %8.1f ms, %.2f of dgbsv, off by %.1e\n",
                  kind == SpikeKind::full ? "full" : "truncated", partitions, count, ms, ms / lapack,
                  (x - reference).norm() / reference.norm());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Index n = argc > 1 ? std::atol(argv[1]) : 100000;
  std::vector<Index> halves = {5, 10, 20, 50};
  if (argc > 2) halves.clear();
  for (int k = 2; k < argc; ++k) halves.push_back(std::atol(argv[k]));
  for (const Index half : halves) compare(n, half);
}
