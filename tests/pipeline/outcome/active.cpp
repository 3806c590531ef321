// Active design on a study whose boundary is known: half the trials of a Sobol' design for the same held-out score.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstdio>

#include "base/math/random.h"
#include "pipeline/outcome/active/choose.h"
#include "tests/pipeline/outcome/known_boundary.h"
#include "tests/support/catch.h"

namespace gonogo::outcome {
using namespace campaign;

namespace {

std::vector<double> unit(const DesignSpec& spec, std::span<const double> variables) {
  std::vector<double> u;
  for (const SampledVariable& r : spec.ranges)
    u.push_back((variables[r.variable] - r.minimum) / (r.maximum - r.minimum));
  return u;
}

/// Gaussian process regression of +1 and -1 (C. E. Rasmussen and C. K. I. Williams, 2006, equations 2.25 and 2.26),
/// P(go) by the probit of its answer: stands for the study's model here, which knows nothing of the boundary's form.
class Surrogate {
 public:
  Surrogate(const DesignSpec& spec, const std::vector<DesignPoint>& points) : spec_(spec) {
    const auto n = Eigen::Index(points.size());
    Eigen::VectorXd label(n);
    for (const DesignPoint& point : points) at_.push_back(unit(spec, point.variables));
    for (Eigen::Index i = 0; i < n; ++i)
      label(i) = 2 * known_boundary_passes(spec, points[std::size_t(i)].variables) - 1;
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) = kernel(at_[std::size_t(i)], at_[std::size_t(j)]);
    covariance.diagonal().array() += 0.01;
    factor_.compute(covariance);
    weight_ = factor_.solve(label);
  }

  double p_go(std::span<const double> variables) const {
    const std::vector<double> u = unit(spec_, variables);
    Eigen::VectorXd near(Eigen::Index(at_.size()));
    for (std::size_t i = 0; i < at_.size(); ++i) near(Eigen::Index(i)) = kernel(u, at_[i]);
    const double variance = std::max(0.0, 1 - near.dot(factor_.solve(near)));
    const double sharp = 4 * near.dot(weight_) / std::sqrt(1 + 16 * variance);
    return 0.5 * std::erfc(-sharp / std::sqrt(2.0));
  }

  ModelAnswers answers() const {
    const std::size_t width = spec_.fixed.size();
    return {.p_go =
                [this, width](std::span<const double> points, std::span<double> p) {
                  for (std::size_t i = 0; i < p.size(); ++i) p[i] = p_go(points.subspan(i * width, width));
                },
            .novelty = [](std::span<const double>) { return 0.0; }};
  }

 private:
  static double kernel(const std::vector<double>& a, const std::vector<double>& b) {
    double squared = 0;
    for (std::size_t j = 0; j < a.size(); ++j) squared += (a[j] - b[j]) * (a[j] - b[j]);
    return std::exp(-squared / (2 * 0.3 * 0.3));
  }

  const DesignSpec& spec_;
  std::vector<std::vector<double>> at_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weight_;
};

double held_out_brier(const DesignSpec& spec, const Surrogate& model) {
  return known_boundary_brier(spec, [&](const std::vector<double>& x) { return model.p_go(x); });
}

double brier_of_sobol(std::uint64_t seed, std::uint64_t points) {
  const DesignSpec spec = known_boundary_box(seed, points);
  return held_out_brier(spec, Surrogate(spec, make_design(spec)));
}

/// 64 seeds, then batches of 32.
double brier_of_active(std::uint64_t seed, std::uint64_t points) {
  const DesignSpec spec = known_boundary_box(seed, 64);
  std::vector<DesignPoint> trials = make_design(spec);
  for (std::uint64_t skip = 64; trials.size() < points; skip += 1024) {
    const Surrogate model(spec, trials);
    for (DesignPoint& point : choose_batch(spec, model.answers(), {.count = 32, .skip = skip, .candidates = 1024}))
      trials.push_back(std::move(point));
  }
  return held_out_brier(spec, Surrogate(spec, trials));
}

TEST_CASE("five repeats: an active design needs at most half the trials of a Sobol' design for the same Brier score") {
  constexpr int kRepeats = 5;
  double mean[2] = {0, 0}, squares[2] = {0, 0};
  for (std::uint64_t seed = 1; seed <= kRepeats; ++seed) {
    const double score[2] = {brier_of_active(seed, 192), brier_of_sobol(seed, 384)};
    for (int k = 0; k < 2; ++k) mean[k] += score[k] / kRepeats, squares[k] += score[k] * score[k] / kRepeats;
  }
  const double spread[2] = {std::sqrt(squares[0] - mean[0] * mean[0]), std::sqrt(squares[1] - mean[1] * mean[1])};
  std::printf("Brier score on held-out points: 192 active trials %.5f +- %.5f, 384 of Sobol' %.5f +- %.5f\n", mean[0],
              spread[0], mean[1], spread[1]);
  CHECK(mean[0] <= mean[1]);
}

TEST_CASE("points are drawn as often as their density says, and weighing by it gives back the uniform box") {
  const DesignSpec spec = known_boundary_box(4, 1);
  const std::size_t slope = spec.ranges[0].variable, width = spec.fixed.size();
  // Unsure between 10 and 20 degrees, 10/35 of the box; sure elsewhere.
  const ModelAnswers model{.p_go =
                               [&](std::span<const double> points, std::span<double> p) {
                                 for (std::size_t i = 0; i < p.size(); ++i) {
                                   const double s = points[i * width + slope];
                                   p[i] = s < 10 ? 1 : s < 20 ? 0.5 : 0;
                                 }
                               },
                           .novelty = [](std::span<const double>) { return 0.0; }};
  const auto batch = choose_batch(spec, model, {.count = 2000, .space_filling = 0.3, .skip = 0, .candidates = 65536});
  REQUIRE(batch.size() == 2000);
  const double band = 10.0 / 35;
  double inside = 0, weight = 0, weighted_inside = 0;
  for (const DesignPoint& point : batch) {
    const bool in = point.variables[slope] >= 10 && point.variables[slope] < 20;
    CHECK(point.proposal_density == Approx(in ? 0.3 + 0.7 / band : 0.3).epsilon(0.01));
    inside += in;
    weight += 1 / point.proposal_density;
    weighted_inside += in / point.proposal_density;
  }
  CHECK(inside / 2000 == Approx(0.7 + 0.3 * band).margin(0.01));
  CHECK(weight / 2000 == Approx(1).margin(0.06));
  CHECK(weighted_inside / weight == Approx(band).margin(0.03));
  CHECK(expected_error(spec, model) == Approx(0.5 * band).margin(0.005));
}

TEST_CASE("places that no trial is near are chosen though the model is sure of them") {
  const DesignSpec spec = known_boundary_box(4, 1);
  const std::size_t slope = spec.ranges[0].variable;
  const ModelAnswers model{
      .p_go = [](std::span<const double>, std::span<double> p) { std::fill(p.begin(), p.end(), 1.0); },
      .novelty = [&](std::span<const double> x) { return x[slope] > 30 ? 3.0 : 1.0; }};
  int novel = 0;
  for (const DesignPoint& point : choose_batch(spec, model, {.count = 100})) novel += point.variables[slope] > 30;
  CHECK(novel >= 75);
}

}  // namespace
}  // namespace gonogo::outcome
