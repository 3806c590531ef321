#include "pipeline/learn/training/capacity.h"

#include "base/file.h"
#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::app {

void capacity_work(const Globals& globals, const CapacityOptions& options) {
  learn::CapacityRequest request = options.request;
  if (!options.study.empty()) {
    const campaign::Study study = campaign::read_study(options.study);
    request.learning = study.config.object_if("learning");
    request.design = study.config.object_if("design");
  }
  const Json report = learn::measure_capacity(request);
  if (!options.out.empty()) write_file_atomically(options.out, learn::capacity_csv(report));
  print_result(globals, report, learn::capacity_text(report));
}

}  // namespace gonogo::app
