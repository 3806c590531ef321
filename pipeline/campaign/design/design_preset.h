// Named ranges for designs. A study says only what it wants otherwise.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::campaign {

/// By name of the variable, in its unit. Variables that are in neither have to be named by the study.
struct DesignPreset {
  std::map<std::string, std::pair<double, double>> ranges;
  std::map<std::string, double> fixed;
};

std::vector<std::string> preset_names();

/// Empty for the empty name.
///
/// study_reproduction  The continuous ranges of the original study (R. Serban's go_nogo programs, projectchrono fork,
///     commit 6e9a73d694, 2017-06-25): slope 0 to 30 degrees, friction 0.2 to 1.0 (as friction angle, atan: 11.3 to 45
///     degrees), straight uphill, tyre friction 0.8, bed of 100 mm, GO at 7 m in 6.5 s, 1.1 m/s. Its cohesion, a
///     contact stress of 100 to 1000 kPa, is no soil's; the bed's goes over all that the contract allows.
/// realistic_soil      Slopes of terrain that vehicles meet and soils from loose sand to firm clay: friction angles of
/// 20
///     to 42 degrees and cohesions up to 25 kPa cover the soils of configs/soils (sources there).
DesignPreset design_preset(const std::string& name);

}  // namespace gonogo::campaign
