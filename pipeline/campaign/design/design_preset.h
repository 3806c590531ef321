// Named ranges for designs. What a study says itself overrides its preset.
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::campaign {

/// By name of the variable, in its unit. The study must give the variables that are in neither map.
struct DesignPreset {
  std::map<std::string, std::pair<double, double>> ranges;
  std::map<std::string, double> fixed;
};

std::vector<std::string> preset_names();

/// Empty for the empty name.
///
///   study_reproduction  the continuous ranges of the original study
///   realistic_soil      slopes that vehicles meet, soils from loose sand to firm clay
///
/// study_reproduction: R. Serban's go_nogo programs, projectchrono fork, commit 6e9a73d694, 2017-06-25. Slope 0 to 30
/// degrees straight uphill, friction 0.2 to 1.0 (as friction angle, atan: 11.3 to 45 degrees), tyre friction 0.8, bed
/// of 100 mm, go at 7 m in 6.5 s, 1.1 m/s. Its cohesion, a contact stress of 100 to 1000 kPa, is no soil's; the preset
/// takes the whole range of the contract.
///
/// realistic_soil: friction angles of 20 to 42 degrees and cohesions up to 25 kPa, which cover the soils of
/// configs/soils (sources there).
DesignPreset design_preset(const std::string& name);

}  // namespace gonogo::campaign
