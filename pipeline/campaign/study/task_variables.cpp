#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::campaign {

std::vector<TaskNumber> task_numbers(const std::string& type) {
  std::vector<TaskNumber> numbers;
  const std::string prefix = type + "_";
  for (std::size_t v = 0; v < contract().variables.size(); ++v) {
    const Variable& variable = contract().variables[v];
    if (is_task_variable(variable) && variable.name.rfind(prefix, 0) == 0)
      numbers.push_back({variable.name.substr(prefix.size()) + "_" + variable.unit, v});
  }
  return numbers;
}

bool has_task_values(std::span<const double> variables) {
  for (std::size_t v = 0; v < variables.size(); ++v)
    if (is_task_variable(contract().variables[v]) && variables[v] != 0) return true;
  return false;
}

}  // namespace gonogo::campaign
