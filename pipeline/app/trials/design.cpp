#include <memory>

#include "base/format.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/design/sobol.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/region/sources.h"

namespace gonogo::app {
namespace {

std::string as_csv(const std::vector<campaign::DesignPoint>& design) {
  const bool with_task = !design.empty() && campaign::has_task_values(design.front().variables);
  std::string text = campaign::point_header_row(with_task) + "\n";
  for (const campaign::DesignPoint& point : design) text += campaign::to_row(point) + "\n";
  return text;
}

std::string as_text(const campaign::DesignSpec& spec, const std::vector<campaign::DesignPoint>& design,
                    const campaign::Coverage& filled, const std::optional<double>& region_share) {
  std::string text = line("%zu trials: %llu points (%s), the rest replicates\n", design.size(),
                          static_cast<unsigned long long>(spec.points), spec.method.c_str());
  for (const campaign::SampledVariable& range : spec.ranges) {
    const campaign::Variable& variable = campaign::contract().variables[range.variable];
    text += line("  %-18s %g to %g %s\n", variable.name.c_str(), range.minimum, range.maximum, variable.unit.c_str());
  }
  for (std::size_t i = 0; i < spec.fixed.size(); ++i) {
    const campaign::Variable& variable = campaign::contract().variables[i];
    if (campaign::is_task_variable(variable) && spec.fixed[i] == 0) continue;
    if (spec.fixed[i] == spec.fixed[i])
      text += line("  %-18s %g %s\n", variable.name.c_str(), spec.fixed[i], variable.unit.c_str());
  }
  for (const campaign::Stratum& stratum : spec.strata)
    text += line("  share %-6.3g       %s\n", stratum.share, stratum.name.c_str());
  text +=
      line("L2 star discrepancy %.3g (independent random points: %.3g)\n", filled.discrepancy, filled.expected_random);
  text += line("widest gap in any one variable: %.2g of its range\n", filled.largest_gap);
  text += line("largest empty ball: radius %.3g of the unit cube's side\n", filled.empty_ball);
  if (region_share) text += line("%.1f %% of the region lies inside the sampled box\n", 100 * *region_share);
  return text + "\n" + as_csv(design);
}

Json as_json(const campaign::DesignSpec& spec, const std::vector<campaign::DesignPoint>& design,
             const campaign::Coverage& filled, const std::optional<double>& region_share) {
  Json result = Json::object();
  result["trials"] = std::uint64_t(design.size());
  result["points"] = spec.points;
  result["discrepancy"] = filled.discrepancy;
  result["discrepancy_of_random"] = filled.expected_random;
  result["widest_gap_share"] = filled.largest_gap;
  result["largest_empty_ball"] = filled.empty_ball;
  if (region_share) result["region_share"] = *region_share;
  return result;
}

/// The points, and how well they fill the box. `region_share`: share of the study's region that lies inside the box
/// [0, 1].
void print_design(const Globals& globals, const campaign::DesignSpec& spec, bool csv,
                  const std::optional<double>& region_share) {
  const std::vector<campaign::DesignPoint> design = campaign::make_design(spec);
  const campaign::Coverage filled = campaign::coverage(spec, design);
  print_result(globals, as_json(spec, design, filled, region_share),
               csv ? as_csv(design) : as_text(spec, design, filled, region_share));
}

struct DesignOptions {
  std::filesystem::path study;
  bool csv = false;  // the table of points alone
};

void print_with_region(const Globals& globals, const DesignOptions& options) {
  const campaign::Study study = campaign::read_study(options.study);
  const campaign::DesignSpec spec = campaign::read_design(study.section("design"), study.seed);
  print_design(globals, spec, options.csv, map::share_inside(map::read_region(study.region), spec));
}

}  // namespace

void add_design_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("design", "Show which points a study's campaign will simulate");
  const auto options = std::make_shared<DesignOptions>();
  add_named(*command, "study", options->study, kStudy, "Study file (JSON)")->required();
  command->add_flag("--csv", options->csv, "Only the table of points, comma-separated");
  add_examples(*command, {"gonogo design configs/studies/demo.json --csv > design.csv"});
  command->callback([options, command, &globals] {
    const campaign::Study study = campaign::read_study(options->study);
    campaign::check_study(study);
    if (!study.region.empty() && left_out_by(*command).empty())
      return do_work<print_with_region>(*command, globals, *options);
    print_design(globals, campaign::read_design(study.section("design"), study.seed), options->csv, std::nullopt);
  });
}

}  // namespace gonogo::app
