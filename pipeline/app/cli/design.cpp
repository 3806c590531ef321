#include "pipeline/campaign/design/design.h"

#include <memory>

#include "pipeline/app/cli/command.h"
#include "pipeline/app/work/design_report.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::app {

void add_design_command(CLI::App& app, const Globals& globals, const Work<DesignOptions>& with_region) {
  CLI::App* command = app.add_subcommand("design", "Show which points a study's campaign will simulate");
  const auto options = std::make_shared<DesignOptions>();
  command->add_option("study", options->study, "Study file (JSON)")->type_name(kStudy)->required();
  command->add_flag("--csv", options->csv, "Only the table of points, comma-separated");
  add_examples(*command, {"gonogo design configs/studies/demo.json --csv > design.csv"});
  command->callback([options, with_region, &globals] {
    const campaign::Study study = campaign::read_study(options->study);
    campaign::check_study(study);
    if (with_region && !study.region.empty()) return with_region(globals, *options);
    print_design(globals, campaign::read_design(study.section("design"), study.seed), options->csv, std::nullopt);
  });
}

}  // namespace gonogo::app
