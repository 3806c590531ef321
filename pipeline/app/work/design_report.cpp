#include "pipeline/app/work/design_report.h"

#include "base/line.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/design/coverage.h"
#include "pipeline/campaign/study/task_variables.h"

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

}  // namespace

void print_design(const Globals& globals, const campaign::DesignSpec& spec, bool csv,
                  const std::optional<double>& region_share) {
  const std::vector<campaign::DesignPoint> design = campaign::make_design(spec);
  const campaign::Coverage filled = campaign::coverage(spec, design);
  print_result(globals, as_json(spec, design, filled, region_share),
               csv ? as_csv(design) : as_text(spec, design, filled, region_share));
}

}  // namespace gonogo::app
