// Trains a model of trials, exports one question to it as a QUBO, samples that, and reads the answer back:
// train_and_anneal <dataset.h5> <folder>. Any annealer may take the sampler's place between the two files.
#include <gonogo/learn.h>
#include <gonogo/qubo.h>

#include <cstdio>
#include <exception>

using namespace gonogo::api;

int main(int argc, char** argv) try {
  if (argc != 3) throw InputError("usage: train_and_anneal <dataset.h5> <folder>");
  const std::filesystem::path folder = argv[2];
  std::filesystem::create_directories(folder);
  const auto model = folder / "model.h5", problem = folder / "problem.json", answer = folder / "answer.json";
  std::printf("%s", train({.dataset = argv[1], .model = model}).text.c_str());

  // Which outcomes and other variables go with twelve degrees uphill?
  const Values question{{"slope_along", 12}};
  export_problem({.model = model, .problem = problem, .clamped = question, .code_penalty = 8});
  sample_file(problem, answer, {.name = "tempering"}, {.count = 2000});

  const ImportedAnswer read = import_answer({.problem = problem, .answer = answer, .model = model});
  std::printf("%.0f reads, %.0f valid, bias: %s\n", read.reads, read.valid, read.bias.c_str());
  for (const ReadOutcome& outcome : read.outcomes)
    std::printf("%-24s %.3f +- %.3f\n", outcome.name.c_str(), outcome.frequency, outcome.standard_error);
  std::printf("P(go) of the model itself: %.3f\n", Model::read(model).p_go(question));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
