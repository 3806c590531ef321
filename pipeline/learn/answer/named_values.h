// Values of variables as the command line gives them: "slope_along=12".
#pragma once
#include <map>
#include <string>
#include <vector>

namespace gonogo::learn {

/// Parses name=number pairs. Throws InputError for texts of another form, numbers outside the contract's range, and
/// variables given twice. For an unknown variable the error suggests the nearest valid name.
std::map<std::string, double> parse_named_values(const std::vector<std::string>& texts);

/// The values in the order of the contract [variable count]; NaN where none was given.
std::vector<double> to_variables(const std::map<std::string, double>& values);

}  // namespace gonogo::learn
