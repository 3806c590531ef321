#include "pipeline/active/active_run.h"

#include <algorithm>

#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "pipeline/active/choose.h"
#include "pipeline/active/point_list.h"
#include "pipeline/learn/predictor.h"
#include "pipeline/learn/train_model.h"

namespace gonogo::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kCandidates = 128;  // of each point that is chosen

ModelAnswers answers_of(const Predictor& predictor) {
  return {.p_go = [&](std::span<const double> points, std::span<double> p) { predictor.p_go(points, p); },
          .novelty = [&](std::span<const double> point) { return predictor.novelty(point); }};
}

Predictor train(const ActiveRequest& request, const fs::path& dataset) {
  const fs::path model = request.folder / "model.h5";
  train_model({.dataset = dataset,
               .model = model,
               .seed = request.study.seed,
               .learning = request.study.config.object_if("learning"),
               .design = request.study.config.object_if("design")});
  return Predictor::read(model);
}

std::vector<DesignPoint> first_batch(DesignSpec spec, std::uint64_t count) {
  spec.method = "sobol";
  spec.points = count;
  spec.replicate_every = 0;
  return make_design(spec);
}

}  // namespace

ActiveSummary run_active(const ActiveRequest& request) {
  const Config section = request.study.section("design");
  if (section.choice("method", {"sobol", "latin_hypercube", "factorial", "csv", "original"}) != "csv")
    section.fail("method",
                 "an active study has the method csv, with \"ranges\" and the \"file\" that is to be written");
  const DesignSpec box = read_design_box(section, request.study.seed);
  const fs::path file = section.path("file");
  ActiveSummary summary;
  if (listed_points(file, box) == 0) append_points(file, box, first_batch(box, request.seeds));
  for (;;) {
    summary.points = listed_points(file, box);
    summary.campaign = run_campaign(plan_study_campaign(request.study, request.folder, request.compute));
    const Predictor predictor = train(request, summary.campaign.dataset);
    summary.confidence = 1 - expected_error(box, answers_of(predictor));
    summary.reached = summary.confidence >= request.confidence;
    log_line("active", line("%llu points: the model expects to be right in %.1f %% of the box",
                            static_cast<unsigned long long>(summary.points), 100 * summary.confidence));
    if (summary.reached || summary.points >= request.most_points) return summary;
    const std::uint64_t count = std::min(request.batch, request.most_points - summary.points);
    append_points(file, box,
                  choose_batch(box, answers_of(predictor),
                               {.count = count,
                                .space_filling = request.space_filling,
                                .skip = kCandidates * summary.points,
                                .candidates = kCandidates * count}));
  }
}

}  // namespace gonogo::pipeline
