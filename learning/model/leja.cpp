#include "learning/model/leja.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"

namespace gonogo::learning {
namespace {

double product_of_distances(std::span<const double> nodes, double t) {
  double product = 1;
  for (const double x : nodes) product *= std::abs(t - x);
  return product;
}

/// Where the product of distances is largest between two neighbouring nodes: its logarithm is concave there.
double largest_between(std::span<const double> nodes, double low, double high) {
  for (int step = 0; step < 100; ++step) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (product_of_distances(nodes, a) < product_of_distances(nodes, b))
      low = a;
    else
      high = b;
  }
  return (low + high) / 2;
}

struct LejaTable {
  std::array<double, kLejaCount> node;
  std::array<double, kLejaCount> scale;  // 1 / prod_{m < k} (x_k - x_m)

  LejaTable() {
    std::vector<double> known = {0, 1};
    while (known.size() < kLejaCount) {
      std::vector<double> sorted = known;
      std::sort(sorted.begin(), sorted.end());
      double best = 0, most = 0;
      for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
        const double t = largest_between(known, sorted[i], sorted[i + 1]), here = product_of_distances(known, t);
        if (here > most * (1 + 1e-9)) best = t, most = here;  // of two alike by symmetry, the first
      }
      known.push_back(best);
    }
    std::copy(known.begin(), known.end(), node.begin());
    for (std::size_t k = 0; k < kLejaCount; ++k) {
      scale[k] = 1;
      for (std::size_t m = 0; m < k; ++m) scale[k] /= node[k] - node[m];
    }
  }
};

const LejaTable& leja_table() {
  static const LejaTable table;
  return table;
}

}  // namespace

double leja_point(int k) { return leja_table().node[std::size_t(k)]; }

void leja_terms(double t, std::span<double> terms) {
  GONOGO_ASSERT(terms.size() <= std::size_t(kLejaCount));
  const LejaTable& table = leja_table();
  double product = 1;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    terms[k] = product * table.scale[k];
    product *= t - table.node[k];
  }
}

}  // namespace gonogo::learning
