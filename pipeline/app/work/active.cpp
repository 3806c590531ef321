#include "pipeline/learn/active/active_run.h"

#include "base/line.h"
#include "pipeline/app/work/campaign_report.h"
#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::app {

void active_work(const Globals& globals, const ActiveOptions& options) {
  const learn::ActiveSummary done = learn::run_active({.study = campaign::read_study(options.study),
                                                       .folder = options.folder,
                                                       .compute = options.compute,
                                                       .seeds = options.seeds,
                                                       .batch = options.batch,
                                                       .max_points = options.max_points,
                                                       .confidence = options.confidence,
                                                       .space_filling = options.space_filling});
  Json result = campaign_json(done.campaign);
  result["points"] = done.points;
  result["confidence"] = done.confidence;
  result["reached"] = done.reached;
  print_result(
      globals, result,
      campaign_text(done.campaign) + line("\n%llu points; the model expects to be right in %.1f %% of the box",
                                          static_cast<unsigned long long>(done.points), 100 * done.confidence));
}

}  // namespace gonogo::app
