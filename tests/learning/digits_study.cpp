// Densities and labels of handwritten digits beside another program's machine; scripts/digits.sh runs it.
//
//   learning_digits <train> <test> <machine>    rows of 64 pixels and a label; weights of the other program
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "learning/likelihood/likelihood.h"
#include "learning/rbm/train.h"
#include "tests/learning/digit_rows.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

void print_bracket(const char* who, const RbmWeights& machine, const Digits& test) {
  const AnnealingSettings settings{.steps = 10'000, .chains = 100, .row_chains = 1, .seed = 1};
  const LikelihoodBracket b = bracket_log_likelihood(machine, test.pixels, settings);
  std::printf("%-34s AIS %8.3f [%8.3f, %8.3f]   RAISE %8.3f +- %.3f   (%.0f of 100 chains effective)\n", who, b.mean,
              b.low, b.high, b.raise, b.raise_error, b.effective_chains);
  std::fflush(stdout);
}

RbmWeights density(const Digits& train, std::size_t hidden) {
  TrainingSettings settings = density_settings(hidden);
  return train_rbm(pixel_layout(false), digit_table(train, false), settings, *make_sampler("block_gibbs")).weights;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: learning_digits <train> <test> <machine>\n"), 2;
  const Digits train = read_digits(argv[1]), test = read_digits(argv[2]);
  const RbmWeights other = read_machine(argv[3]);
  print_bracket("test pixels, scikit-learn", other, test);
  print_bracket("test pixels, gonogo", density(train, other.hidden_count), test);
  const RbmWeights labels =
      train_rbm(pixel_layout(true), digit_table(train, true), hybrid_settings(), *make_sampler("block_gibbs")).weights;
  std::printf("label accuracy of gonogo, hybrid objective: train %.4f, test %.4f\n", label_accuracy(labels, train),
              label_accuracy(labels, test));
  return 0;
}
