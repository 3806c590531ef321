#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/other_fidelity.h"
#include "pipeline/learn/training/train_members.h"
#include "pipeline/learn/training/train_model.h"

namespace gonogo::app {
namespace {

learn::TrainRequest to_request(const TrainOptions& options) {
  const std::vector<std::filesystem::path> datasets = learn::finest_first(options.datasets);
  learn::TrainRequest request{.dataset = datasets.front(),
                              .model = options.out,
                              .seed = options.seed.value_or(1),
                              .learning = {},
                              .design = {},
                              .hold_out = options.hold_out,
                              .others = {datasets.begin() + 1, datasets.end()},
                              .members_follow = options.members > 0};
  if (options.study.empty()) return request;
  const campaign::Study study = campaign::read_study(options.study);
  if (!options.seed) request.seed = study.seed;
  request.learning = study.config.object_if("learning");
  request.design = study.config.object_if("design");
  return request;
}

}  // namespace

void train_work(const Globals& globals, const TrainOptions& options) {
  const learn::TrainRequest request = to_request(options);
  Json report = learn::train_model(request);
  const std::string text = learn::report_text(report);
  report["model"] = options.out.string();
  if (options.members > 0) {
    Json members = Json::array();
    for (const auto& file : learn::train_members(request, options.members)) members.push_back(Json(file.string()));
    report["members"] = members;
  }
  print_result(globals, report, text);
}

}  // namespace gonogo::app
