// The neural network that models are compared with.
#include <cmath>
#include <cstdio>

#include "learning/rbm/regression/baselines.h"
#include "learning/score/score.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

template <class Model>
double brier_of(const Model& model, const TrainingTable& table) {
  std::vector<double> p;
  for (std::size_t n = 0; n < table.row_count(); ++n) p.push_back(model(table.row(n)));
  return brier_score(p, labels_of(table));
}

}  // namespace

TEST_CASE("the network learns a curved edge that logistic regression cannot, and a straight one as well as it") {
  for (const Boundary boundary : {Boundary::straight, Boundary::curved}) {
    const TrainingTable table = boundary_table(600, 4, boundary), fresh = boundary_table(4000, 99, boundary);
    const double network = brier_of(fit_network(table, labels_of(table)), fresh);
    const double logistic = brier_of(fit_logistic(table, labels_of(table)), fresh);
    double truth = 0;
    for (std::size_t n = 0; n < fresh.row_count(); ++n) {
      const double p = true_p_go(fresh.row(n), boundary);
      truth += p * (1 - p) / double(fresh.row_count());
    }
    std::printf("%s edge, Brier on 4000 fresh rows: network %.4f, logistic regression %.4f, truth %.4f\n",
                boundary == Boundary::straight ? "straight" : "curved", network, logistic, truth);
    if (boundary == Boundary::curved) CHECK(network < 0.8 * logistic);
    CHECK(network < truth + 0.025);
  }
}

TEST_CASE("the network is a function of its seed, takes unknown inputs at their mean, and its folds are held out") {
  const TrainingTable table = boundary_table(120, 4);
  const auto label = labels_of(table);
  const NetworkModel one = fit_network(table, label), two = fit_network(table, label);
  NetworkSettings other;
  other.seed = 2;
  CHECK(one.input_weight == two.input_weight);
  CHECK_FALSE(fit_network(table, label, other).input_weight == one.input_weight);
  std::vector<double> x(table.row(3).begin(), table.row(3).end());
  x[1] = one.mean[1];
  const double at_mean = one(x);
  x[1] = NAN;
  CHECK(one(x) == at_mean);
  const auto fold = assign_folds(table, 3, 1);
  const auto out =
      out_of_fold(table, label, fold, 3, [](const auto& rows, auto labels) { return fit_network(rows, labels); });
  std::vector<std::size_t> others;
  std::vector<int> other_label;
  for (std::size_t n = 0; n < fold.size(); ++n)
    if (fold[n] != fold[0]) {
      others.push_back(n);
      other_label.push_back(label[n]);
    }
  CHECK(out[0] == fit_network(table.subset(others), other_label)(table.row(0)));
}
