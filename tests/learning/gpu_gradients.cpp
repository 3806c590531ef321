// Gradients that LibTorch works out on a GPU against the same on a core. Needs a LibTorch that has CUDA, and a GPU.
#include <cmath>

#include "base/math/random.h"
#include "learning/rbm/train.h"
#include "learning/sampler/exact.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

double largest_difference(const RbmWeights& a, const RbmWeights& b) {
  double max = 0;
  for (auto part : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias}) {
    REQUIRE((a.*part).size() == (b.*part).size());
    for (std::size_t k = 0; k < (a.*part).size(); ++k) max = std::fmax(max, std::fabs((a.*part)[k] - (b.*part)[k]));
  }
  return max;
}

TrainingSettings on(GradientDevice device) {
  TrainingSettings settings;
  settings.epochs = 20;
  settings.generative = 0.3;
  settings.centred = true;
  settings.gradients = device;
  return settings;
}

}  // namespace

TEST_CASE("the objective and its gradient are the CPU's, also with unknown variables") {
  REQUIRE(gradients_on_gpu());
  const VisibleLayout layout = boundary_layout();
  TrainingTable table = boundary_table(60, 3);
  for (std::size_t n = 0; n < table.row_count(); n += 7) table.variables[n * table.variable_count] = NAN;
  RbmWeights machine = RbmWeights::zeros(layout.unit_count(), 4);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = random_unit(4, 4, k++) - 0.5;
  const SampleSet negative =
      make_sampler("block_gibbs")->sample(to_qubo(machine, layout.unit_labels()), {.reads = 30, .seed = 2});
  const Objective cpu = training_objective(machine, layout, table, on(GradientDevice::cpu), negative);
  const Objective gpu = training_objective(machine, layout, table, on(GradientDevice::cuda), negative);
  CHECK(gpu.value == Approx(cpu.value).epsilon(1e-12));
  CHECK(largest_difference(gpu.gradient, cpu.gradient) < 1e-12);
}

TEST_CASE("training on the GPU gives the same bits again, and the CPU's machine but for rounding") {
  REQUIRE(gradients_on_gpu());
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 3);
  const auto sampler = make_sampler("block_gibbs");
  const TrainingResult gpu = train_rbm(layout, table, on(GradientDevice::cuda), *sampler);
  CHECK(gpu.weights == train_rbm(layout, table, on(GradientDevice::cuda), *sampler).weights);
  // A draw would have to fall within 1e-12 of its probability to come out otherwise.
  CHECK(largest_difference(gpu.weights, train_rbm(layout, table, on(GradientDevice::cpu), *sampler).weights) < 1e-8);
}
