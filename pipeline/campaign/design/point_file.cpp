#include "pipeline/campaign/design/point_file.h"

#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/csv.h"
#include "base/error.h"
#include "base/line.h"
#include "base/units.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDensity = "proposal_density";

void check_range(const fs::path& file, std::size_t line_number, const Variable& variable, double value) {
  if (value < variable.minimum || value > variable.maximum)
    refuse_csv_line(file, line_number,
                    line("%s is %g %s, allowed is [%g, %g]", variable.name.c_str(), value, variable.unit.c_str(),
                         variable.minimum, variable.maximum));
}

/// Sizes of obstacles may be left out: 0, there is none.
void complete(const fs::path& file, DesignPoint& point) {
  for (std::size_t i = 0; i < point.variables.size(); ++i)
    if (std::isnan(point.variables[i]) && is_task_variable(contract().variables[i]))
      point.variables[i] = 0;
    else if (std::isnan(point.variables[i]))
      throw InputError(file.string() + ": variable \"" + contract().variables[i].name +
                       "\" is neither a column nor under \"fixed\" of the study's design");
}

}  // namespace

std::vector<DesignPoint> read_point_csv(const fs::path& file, const std::vector<double>& fixed) {
  const auto lines = read_csv_lines(file, "points");
  std::vector<std::optional<std::size_t>> columns;  // variable of each; nothing: the density
  for (const std::string& name : lines.front().cells()) {
    if (name == kDensity) {
      columns.emplace_back();
      continue;
    }
    try {
      columns.emplace_back(contract().variable_index(name));
    } catch (const InputError& error) {
      refuse_csv_line(file, lines.front().number, error.what());
    }
    if (!std::isnan(fixed[*columns.back()]))
      refuse_csv_line(file, lines.front().number, "\"" + name + "\" is fixed by the study");
  }
  std::vector<DesignPoint> points;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const std::size_t number = lines[row].number;
    const std::vector<std::string> cells = lines[row].cells();
    if (cells.size() != columns.size())
      refuse_csv_line(file, number,
                      "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(columns.size()));
    DesignPoint& point = points.emplace_back();
    point.variables = fixed;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double value = csv_number(file, number, cells[i]);
      if (!columns[i] && value <= 0) refuse_csv_line(file, number, "a proposal density is above 0");
      if (columns[i]) check_range(file, number, contract().variables[*columns[i]], value);
      (columns[i] ? point.variables[*columns[i]] : point.proposal_density) = value;
    }
    complete(file, point);
  }
  if (points.empty()) throw InputError(file.string() + ": holds a header and no points");
  return points;
}

std::vector<DesignPoint> read_original_points(const fs::path& file, const std::vector<double>& fixed,
                                              double cohesion_scale) {
  const std::size_t slope = contract().variable_index("slope_along"),
                    angle = contract().variable_index("friction_angle"),
                    cohesion = contract().variable_index("cohesion");
  std::vector<DesignPoint> points;
  std::array<double, 2> grains{};
  for (const auto& [number, text] : read_csv_lines(file, "points")) {
    std::istringstream in(text);
    std::array<double, 5> values{};
    std::string cell;
    for (double& value : values) {
      if (!(in >> cell))
        refuse_csv_line(file, number, "five numbers are needed: slope, radius, density, friction, cohesion");
      value = csv_number(file, number, cell);
    }
    if (in >> cell) refuse_csv_line(file, number, "holds more than five numbers");
    const std::array<double, 2> these{values[1], values[2]};
    if (points.empty()) grains = these;
    if (these != grains)
      refuse_csv_line(file, number,
                      line("grains of %g mm and %g kg/m^3, above %g mm and %g kg/m^3: one study has one kind of "
                           "grains; make a file for each",
                           these[0], these[1], grains[0], grains[1]));
    DesignPoint& point = points.emplace_back();
    point.variables = fixed;
    point.variables[slope] = values[0];
    point.variables[angle] = std::atan(values[3]) / kDegree;
    point.variables[cohesion] = values[4] * cohesion_scale;
    for (const std::size_t i : {slope, angle, cohesion})
      check_range(file, number, contract().variables[i], point.variables[i]);
    complete(file, point);
  }
  return points;
}

}  // namespace gonogo::campaign
