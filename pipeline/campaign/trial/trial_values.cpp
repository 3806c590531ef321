#include "pipeline/campaign/trial/trial_values.h"

#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::campaign {
namespace {

/// "between -45 and 45 deg"
std::string allowed(const Variable& v) { return line("between %g and %g %s", v.minimum, v.maximum, v.unit.c_str()); }

}  // namespace

std::vector<double> middle_values(const Study& study) {
  std::vector<double> values(contract().variables.size(), std::nan(""));
  const Config design = study.section("design");
  const auto fixed = design.object_if("fixed"), ranges = design.object_if("ranges");
  for (std::size_t v = 0; v < values.size(); ++v) {
    const std::string& name = contract().variables[v].name;
    if (is_task_variable(contract().variables[v])) values[v] = 0;
    if (fixed && fixed->has(name)) values[v] = fixed->number(name);
    if (ranges && ranges->has(name)) values[v] = 0.5 * (ranges->numbers(name).at(0) + ranges->numbers(name).at(1));
  }
  return values;
}

std::vector<double> usual_values(const TrialSetup& setup) {
  const terrain::AngleRange reach = terrain::reachable_angles(setup.calibration);
  std::vector<double> values(contract().variables.size(), 0);
  const auto set = [&](const char* name, double x) { values[contract().variable_index(name)] = x; };
  set("friction_angle", 0.5 * (reach.lowest + reach.highest));
  set("relative_density", 0.5);
  set("tyre_friction", setup.whole ? setup.whole->wheel.front().friction : 0.8);
  set("bed_depth", 0.3);
  set("commanded_speed", 1.5);
  return values;
}

void set_value(std::vector<double>& values, const std::string& name, double value, const std::string& where) {
  const std::size_t v = contract().variable_index(name);
  const Variable& variable = contract().variables[v];
  if (!(value >= variable.minimum && value <= variable.maximum))
    throw InputError(where + ": the value must be a number " + allowed(variable));
  values[v] = value;
}

void check_all_given(const std::vector<double>& values, const std::string& where) {
  for (std::size_t v = 0; v < values.size(); ++v)
    if (std::isnan(values[v])) {
      const Variable& variable = contract().variables[v];
      throw InputError(where + ": design has neither a fixed value nor a range of " + variable.name + ", " +
                       allowed(variable) + "; give one: --set " + variable.name + "=...");
    }
}

}  // namespace gonogo::campaign
