// Densities and labels of handwritten digits beside another program's machine; scripts/digits.sh runs it.
//
//   learning_digits density <train> <test> <machine>                     rows of bits and a label; the other's weights
//   learning_digits labels <train> <test> <name> [setting=value ...]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "learning/rbm/train.h"
#include "tests/learning/digit_rows.h"
#include "tests/learning/machine_likelihood.h"

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
  return train_rbm(pixel_layout(train.width, false), digit_table(train, false), settings, *make_sampler("block_gibbs"))
      .weights;
}

/// name=value
void set(TrainingSettings& settings, const std::string& word) {
  const std::size_t equals = word.find('=');
  const std::string name = word.substr(0, equals);
  const double value = equals == std::string::npos ? NAN : std::atof(word.c_str() + equals + 1);
  if (name == "hidden")
    settings.hidden = std::size_t(value);
  else if (name == "epochs")
    settings.epochs = settings.report_every = std::size_t(value);
  else if (name == "generative")
    settings.generative = value;
  else if (name == "weight_decay")
    settings.weight_decay = value;
  else if (name == "learning_rate")
    settings.learning_rate = value;
  else if (name == "initial_weight")
    settings.initial_weight = value;
  else if (name == "centred")
    settings.centred = value > 0;
  else
    throw InputError("setting " + word + " does not exist");
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string what = argc > 1 ? argv[1] : "";
  if (argc < 5 || (what != "density" && what != "labels")) {
    std::fprintf(stderr,
                 "usage: learning_digits density <train> <test> <machine>\n"
                 "       learning_digits labels <train> <test> <test name> [setting=value ...]\n");
    return 2;
  }
  const Digits train = read_digits(argv[2]), test = read_digits(argv[3]);
  if (what == "density") {
    const RbmWeights other = read_machine(argv[4]);
    print_bracket("test pixels, scikit-learn", other, test);
    print_bracket("test pixels, gonogo", density(train, other.hidden_count), test);
    return 0;
  }
  TrainingSettings settings = hybrid_settings();
  for (int k = 5; k < argc; ++k) set(settings, argv[k]);
  const RbmWeights machine =
      train_rbm(pixel_layout(train.width, true), digit_table(train, true), settings, *make_sampler("block_gibbs"))
          .weights;
  std::printf("label accuracy of gonogo, hybrid objective, %s: train %.4f, test %.4f\n", argv[4],
              label_accuracy(machine, train), label_accuracy(machine, test));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
