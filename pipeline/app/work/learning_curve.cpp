#include "pipeline/learn/evaluation/learning_curve.h"

#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/other_fidelity.h"

namespace gonogo::app {

void learning_curve_work(const Globals& globals, const LearningCurveOptions& options) {
  learn::LearningCurveRequest request;
  const std::vector<std::filesystem::path> datasets = learn::finest_first(options.datasets);
  request.training.dataset = datasets.front();
  request.training.others.assign(datasets.begin() + 1, datasets.end());
  request.training.seed = options.seed.value_or(1);
  request.training.hold_out = options.hold_out;
  request.trials = options.trials;
  request.subsets = options.subsets;
  request.active = options.active;
  request.folder = options.out;
  if (!options.study.empty()) {
    const campaign::Study study = campaign::read_study(options.study);
    if (!options.seed) request.training.seed = study.seed;
    request.training.learning = study.config.object_if("learning");
    request.training.design = study.config.object_if("design");
  }
  const Json curve = learn::learning_curve(request);
  std::string text = learn::learning_curve_text(curve);
  for (const auto& file : learn::write_learning_curve(options.out, curve)) text += file.string() + "\n";
  print_result(globals, curve, text);
}

}  // namespace gonogo::app
