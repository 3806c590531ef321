// Distance from the trials against the formula taken trial by trial.
#include "pipeline/outcome/answer/novelty.h"

#include <algorithm>
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/draw.h"

namespace gonogo::outcome {
namespace {

constexpr std::size_t kVariables = 4;  // the third is held fixed

learning::Model model_of(std::size_t trials, bool complete) {
  std::vector<learning::Encoder> encoders;
  for (const char* name : {"a", "b", "fixed", "c"})
    encoders.push_back(learning::Encoder::by_range(name, "-", learning::Code::thermometer, 3, 0, 4));
  learning::Model model;
  model.layout = learning::VisibleLayout(std::move(encoders), {"go", "no_go"});
  model.sampled_lower = {0, -2, 1, 0};
  model.sampled_upper = {4, 2, 1, 10};
  test::Draw draw(7);
  for (std::size_t n = 0; n < trials; ++n) {
    for (std::size_t v = 0; v < kVariables; ++v) model.training_points.push_back(draw.between(-2, 4));
    if (!complete && n % 5 == 0) model.training_points[n * kVariables + 1] = NAN;
    model.training_outcomes.push_back(0);
  }
  return model;
}

double distance(const learning::Model& model, const double* a, const double* b) {
  double sum = 0, known = 0;
  for (std::size_t v = 0; v < kVariables; ++v) {
    if (v == 2 || std::isnan(a[v]) || std::isnan(b[v])) continue;
    const double d = (a[v] - b[v]) / (model.sampled_upper[v] - model.sampled_lower[v]);
    sum += d * d;
    known += 1;
  }
  return known > 0 ? std::sqrt(sum / known) : 0;
}

double nearest(const learning::Model& model, const double* point, std::size_t skip) {
  double least = INFINITY;
  for (std::size_t n = 0; n < model.training_outcomes.size(); ++n)
    if (n != skip) least = std::min(least, distance(model, point, &model.training_points[n * kVariables]));
  return least;
}

}  // namespace

TEST_CASE("novelty is the distance to the nearest trial over the median between neighbours") {
  const learning::Model model = model_of(31, GENERATE(true, false));
  std::vector<double> neighbours;
  for (std::size_t n = 0; n < 31; ++n) neighbours.push_back(nearest(model, &model.training_points[n * kVariables], n));
  std::sort(neighbours.begin(), neighbours.end());
  const Novelty novelty(model);
  test::Draw draw(8);
  for (int k = 0; k < 50; ++k) {
    double point[kVariables];
    for (double& x : point) x = draw.between(-4, 6);
    if (k % 3 == 0) point[k % 2] = NAN;
    CHECK(novelty.of(point) == Approx(nearest(model, point, 31) / neighbours[15]).epsilon(1e-6));
  }
  CHECK(novelty.of(std::span(model.training_points).subspan(kVariables, kVariables)) == 0);
}

TEST_CASE("novelty along a variable is that of its points, one by one") {
  const learning::Model model = model_of(GENERATE(1, 31), GENERATE(true, false));
  const Novelty novelty(model);
  test::Draw draw(9);
  std::vector<double> values{-50, -2, -2};  // far outside, and the same twice
  for (int k = 0; k < 60; ++k) values.push_back(-4 + 10 * double(k) / 59);
  for (std::size_t n = 0; n < model.training_outcomes.size(); ++n)  // the trials' own values
    values.push_back(model.training_points[n * kVariables]);
  std::erase_if(values, [](double x) { return std::isnan(x); });
  std::sort(values.begin(), values.end());
  for (std::size_t variable = 0; variable < kVariables; ++variable) {  // the third is no axis
    double point[kVariables];
    for (double& x : point) x = draw.between(-3, 5);
    if (variable == 3) point[0] = NAN;
    std::vector<double> along(values.size());
    novelty.along(point, variable, values, along);
    for (std::size_t i = 0; i < values.size(); ++i) {
      point[variable] = values[i];
      INFO("variable " << variable << " at " << values[i]);
      CHECK(along[i] == Approx(novelty.of(point)).epsilon(1e-5).margin(1e-9));
    }
  }
}

TEST_CASE("novelty of one trial alone is the plain distance, and of a point that knows nothing zero") {
  const learning::Model model = model_of(1, true);
  const Novelty novelty(model);
  const double away[] = {1, 1, 1, 1}, nothing[] = {NAN, NAN, NAN, NAN};
  CHECK(novelty.of(away) == nearest(model, away, 1));
  CHECK(novelty.of(nothing) == 0);
}

}  // namespace gonogo::outcome
