// How a machine is trained; learning/rbm/train.h says what the symbols mean, docs/learning.md why these defaults.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::learning {

/// Where the chains of the negative phase start at each update.
enum class NegativePhaseKind {
  persistent,   // where they were at the last update (Tieleman 2008)
  contrastive,  // at the rows of the minibatch: CD-k with k = sweeps (Hinton 2002)
  tempering,    // persistent, on a ladder of temperatures (Desjardins et al. 2010)
  trajectory    // persistent, on a ladder of the run's own earlier machines (Bereux et al. 2024)
};

enum class Optimizer { adam, sgd };

/// `cuda` needs a LibTorch that was built for it, and a GPU: see gradients_on_gpu() in learning/rbm/train.h.
enum class GradientDevice { cpu, cuda };

struct TrainingSettings {
  std::size_t hidden = 8;
  std::size_t epochs = 400;               // most passes over the table
  std::size_t report_every = 10;          // epochs between entries of the log and looks at held-out rows
  std::size_t batch = 32;                 // rows of a minibatch
  Optimizer optimizer = Optimizer::adam;  // Kingma & Ba 2015; or gradient descent with momentum
  double learning_rate = 0.02;
  double final_learning_rate = 1;  // share of it at the last epoch; it falls in equal steps
  double momentum = 0;             // of sgd
  double discriminative = 1;       // share of the first term; 0 trains a purely generative machine
  double generative = 0.05;        // g
  double weight_decay = 1;         // s [nat]: a prior of variance 1 / s on every weight, whatever the number of rows
  double initial_weight = 0.1;     // standard deviation of the first weights
  bool centred = false;            // gradients in centred units (Melchior, Fischer, Wiskott, JMLR 17(99), 2016)
  NegativePhaseKind negative = NegativePhaseKind::persistent;
  std::size_t chains = 64;  // of the negative phase; contrastive: one for each row of the minibatch instead
  std::size_t sweeps = 2;   // of every chain between updates
  std::size_t rungs = 8;    // tempering: machines on the ladder; trajectory: most machines on it
  std::uint64_t seed = 1;
  /// Where LibTorch works out gradients; a machine of tens of units is quicker on one core. The sampler has its own
  /// say.
  GradientDevice gradients = GradientDevice::cpu;
  /// Weights that stay 0, as (visible unit, hidden unit): pairs that hardware with dead qubits cannot couple.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> masked;
};

/// Names in files; the second of each pair throws InputError naming those that exist.
std::string negative_phase_name(NegativePhaseKind kind);
NegativePhaseKind negative_phase_named(const std::string& name);
std::string optimizer_name(Optimizer optimizer);
Optimizer optimizer_named(const std::string& name);
std::string gradient_device_name(GradientDevice device);
GradientDevice gradient_device_named(const std::string& name);

}  // namespace gonogo::learning
