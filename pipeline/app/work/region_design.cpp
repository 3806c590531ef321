#include "pipeline/app/work/design_report.h"
#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/region/region_share.h"

namespace gonogo::app {

void region_design_work(const Globals& globals, const DesignOptions& options) {
  const campaign::Study study = campaign::read_study(options.study);
  const campaign::DesignSpec spec = campaign::read_design(study.section("design"), study.seed);
  print_design(globals, spec, options.csv, map::share_inside(map::read_region(study.region), spec));
}

}  // namespace gonogo::app
