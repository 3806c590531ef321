// Training through an emulated annealer with dead qubits: what has no coupler has no weight, from the first update on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "base/math/random.h"
#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/rbm/train.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr std::size_t kUnits = 8;  // on each side: all lines of C2

VisibleLayout bits() {
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < kUnits; ++i)
    encoders.push_back(Encoder::by_range("bit" + std::to_string(i), "-", Code::thermometer, 2, 0, 1));
  return VisibleLayout(std::move(encoders), {});
}

TrainingTable random_table(std::size_t rows) {
  TrainingTable table;
  table.variable_count = kUnits;
  for (std::size_t k = 0; k < rows * kUnits; ++k)
    table.variables.push_back(random_unit(3, 1, k / 2) < 0.5 ? 0.25 : 0.75);  // pairs of equal bits
  table.outcome.assign(rows, 0);
  table.weight.assign(rows, 1.0);
  for (std::size_t n = 0; n < rows; ++n) table.group.push_back(n);
  return table;
}

}  // namespace

TEST_CASE("pairs that dead qubits leave without a coupler have weight 0 after every epoch, all others learn") {
  const HardwareGraph full = graph_named("chimera:2");
  const Device device{without(full, random_dead_qubits(full, 0.1, 4)), {}, {}, 0.2, false, 4};
  AnnealerSettings annealer;
  annealer.scale = 0.2;
  annealer.chain_coupling = 0.6;
  const AnnealerSampler sampler(std::make_shared<Emulator>(device), device.graph, kUnits, kUnits, annealer);
  TrainingSettings settings;
  settings.hidden = kUnits;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.epochs = 5;
  settings.report_every = 1;
  settings.chains = 20;
  settings.sweeps = 20;
  for (const auto& [visible, hidden] : sampler.embedding().uncoupled)
    settings.masked.emplace_back(visible, hidden - std::uint32_t(kUnits));
  REQUIRE(settings.masked.size() >= 4);
  std::printf("C2, 10 %% dead: %zu of 64 pairs masked\n", settings.masked.size());
  std::size_t looks = 0;
  train_rbm(bits(), random_table(64), settings, sampler, [&](std::size_t, const RbmWeights& machine) {
    ++looks;
    for (const auto& [i, j] : settings.masked) CHECK(machine.weight[i * kUnits + j] == 0);
    const auto zeros = std::size_t(std::count(machine.weight.begin(), machine.weight.end(), 0.0));
    CHECK(zeros == settings.masked.size());
    return true;
  });
  CHECK(looks == 5);
}
