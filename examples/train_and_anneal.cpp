// Trains a model of trials, exports one question to it as a QUBO, samples that, and reads the answer back:
// train_and_anneal <dataset.h5> <folder>. Any annealer may take the sampler's place between the two files.
#include <gonogo/learn.h>
#include <gonogo/qubo.h>

#include <cstdio>
#include <exception>
#include <filesystem>

using namespace gonogo;

int main(int argc, char** argv) try {
  if (argc != 3) throw InputError("usage: train_and_anneal <dataset.h5> <folder>");
  const std::filesystem::path dataset = argv[1], folder = argv[2];
  std::filesystem::create_directories(folder);
  const auto model = folder / "model.h5", problem = folder / "problem.json", answer = folder / "answer.json";

  outcome::TrainRequest request;
  request.dataset = dataset;
  request.model = model;
  request.seed = 1;
  std::printf("%s", outcome::report_text(outcome::train_model(request)).c_str());

  // Which outcomes and other variables go with twelve degrees uphill?
  const double penalty = 8;  // energy of bit patterns that are no code word
  outcome::export_problem(model, problem, {{"slope_along", 12}}, learning::Vartype::binary, {}, penalty);

  learning::SampleRequest reads;
  reads.reads = 2000;
  reads.seed = 1;
  outcome::sample_problem(problem, answer, *learning::make_sampler("tempering"), reads);

  outcome::ImportRequest import;
  import.problem = problem;
  import.answer = answer;
  import.model = model;
  std::printf("%s\n", outcome::to_json(outcome::import_answer(import)).dump(2).c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
