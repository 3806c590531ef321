#include "pipeline/learn/answer/named_values.h"

#include <charconv>
#include <limits>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::learn {

std::map<std::string, double> parse_named_values(const std::vector<std::string>& texts) {
  std::map<std::string, double> values;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
    double value = 0;
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), value);
    if (equals == 0 || parsed.ec != std::errc() || parsed.ptr != number.data() + number.size())
      throw InputError("\"" + text + "\" is not of the form variable=number, as in slope_along=12");
    const std::string name = text.substr(0, equals);
    const campaign::Variable& variable = campaign::contract().variables[campaign::contract().variable_index(name)];
    if (!(value >= variable.minimum && value <= variable.maximum))
      throw InputError(text + ": outside the allowed range, " + line("%g to %g ", variable.minimum, variable.maximum) +
                       variable.unit);
    if (!values.emplace(name, value).second)
      throw InputError(line("%s: %s is given twice", text.c_str(), name.c_str()));
  }
  return values;
}

std::vector<double> to_variables(const std::map<std::string, double>& values) {
  std::vector<double> variables(campaign::contract().variables.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [name, value] : values) variables[campaign::contract().variable_index(name)] = value;
  return variables;
}

}  // namespace gonogo::learn
