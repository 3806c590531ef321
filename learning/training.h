// What training takes: a table of trials, and settings. Symbols: learning/rbm/train.h; reasons for the defaults:
// docs/learning.md.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::learning {

/// One row per valid trial.
struct TrainingTable {
  std::size_t variable_count = 0;
  std::vector<double> variables;     // [row_count() x variable_count], NaN: unknown
  std::vector<std::size_t> outcome;  // [row_count()], index in the layout's outcomes
  std::vector<double> weight;        // [row_count()], > 0: prior / proposal density of the row
  std::vector<std::uint64_t> group;  // [row_count()]: rows of one group (replicates) stay in one fold
  /// [row_count()], or empty where no row has one: a measure of how clearly a row has its outcome, NaN where unknown.
  /// Only teachers see it.
  std::vector<double> margin;

  std::size_t row_count() const { return outcome.size(); }
  std::span<const double> row(std::size_t i) const {
    return std::span(variables).subspan(i * variable_count, variable_count);
  }
  TrainingTable subset(const std::vector<std::size_t>& rows) const;
};

/// Random fold 0 .. fold_count - 1 of every row. Folds have equal sizes; a group is in one fold.
std::vector<std::size_t> assign_folds(const TrainingTable& table, std::size_t fold_count, std::uint64_t seed);

/// A fixed permutation of 0 .. count - 1 for (seed, stream).
std::vector<std::size_t> permutation(std::size_t count, std::uint64_t seed, std::uint64_t stream);

// Training settings of a machine. Symbols: learning/rbm/train.h; reasons for the defaults: docs/learning.md.

/// Start of the negative phase's chains at each update.
enum class NegativePhaseKind {
  persistent,   // the last update's rows (Tieleman 2008)
  contrastive,  // the rows of the minibatch: CD-k with k = sweeps (Hinton 2002)
  tempering,    // persistent, on a ladder of temperatures (Desjardins et al. 2010)
  trajectory,   // persistent, on a ladder of earlier machines of the run (Bereux et al. 2024)
  code_words    // persistent, a whole code word at a time: the machine has no other words (sampler/word_machine.h)
};

enum class Optimizer { adam, sgd };

/// `cuda` needs a GPU and a LibTorch with CUDA: see gradients_on_gpu() in learning/rbm/train.h.
enum class GradientDevice { cpu, cuda };

struct TrainingSettings {
  std::size_t hidden = 8;
  std::size_t epochs = 400;               // max passes over the table
  std::size_t report_every = 10;          // epochs between entries of the log and evaluations on held-out rows
  std::size_t batch = 32;                 // rows of a minibatch
  Optimizer optimizer = Optimizer::adam;  // Kingma & Ba 2015; sgd: gradient descent with momentum
  double learning_rate = 0.02;
  double final_learning_rate = 1;  // share of learning_rate at the last epoch; it falls linearly
  double momentum = 0;             // of sgd
  double discriminative = 1;       // weight of the first term; 0: a purely generative machine
  double generative = 0.05;        // g
  double weight_decay = 1;         // s [nat]: a prior of variance 1 / s on every weight
  double initial_weight = 0.1;     // standard deviation of the initial weights
  bool centred = false;            // gradients in centred units (Melchior, Fischer, Wiskott, JMLR 17(99), 2016)
  NegativePhaseKind negative = NegativePhaseKind::persistent;
  std::size_t chains = 64;  // of the negative phase; contrastive: one per row of the minibatch
  std::size_t sweeps = 2;   // of every chain per update
  std::size_t rungs = 8;    // tempering: machines on the ladder; trajectory: max machines on it
  std::uint64_t seed = 1;
  /// Device of LibTorch's gradients. One core is faster for a machine of tens of units. The sampler has its own device.
  GradientDevice gradients = GradientDevice::cpu;
  /// Weights that stay 0, as (visible unit, hidden unit): pairs that the hardware cannot couple.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> masked;
};

/// Names in files. The second function of each pair throws InputError that lists the names.
std::string negative_phase_name(NegativePhaseKind kind);
NegativePhaseKind negative_phase_named(const std::string& name);
std::string optimizer_name(Optimizer optimizer);
Optimizer optimizer_named(const std::string& name);
std::string gradient_device_name(GradientDevice device);
GradientDevice gradient_device_named(const std::string& name);

}  // namespace gonogo::learning
