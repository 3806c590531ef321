// "slope_along=12" on the command line.
#pragma once
#include <map>
#include <string>
#include <vector>

namespace gonogo::learn {

/// name=number pairs. Throws InputError for texts of another form, unknown variables (with the nearest valid name),
/// numbers outside the contract's range, and variables given twice.
std::map<std::string, double> parse_named_values(const std::vector<std::string>& texts);

/// In the order of the contract; not-a-number where nothing was given.
std::vector<double> to_variables(const std::map<std::string, double>& values);

}  // namespace gonogo::learn
