#include "pipeline/campaign/design/point_file.h"

#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "base/units.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDensity = "proposal_density";

/// Lines without their ends, comments and blank lines left out, with their numbers from 1.
std::vector<std::pair<std::size_t, std::string>> lines_of(const fs::path& file) {
  std::istringstream in(read_file(file));
  std::vector<std::pair<std::size_t, std::string>> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::size_t first = text.find_first_not_of(" \t");
    if (first != std::string::npos && text[first] != '#') lines.emplace_back(number, text);
  }
  if (lines.empty()) throw InputError(file.string() + ": holds no points");
  return lines;
}

[[noreturn]] void refuse(const fs::path& file, std::size_t line_number, const std::string& what) {
  throw InputError(file.string() + ": line " + std::to_string(line_number) + ": " + what);
}

double number_in(const fs::path& file, std::size_t line_number, const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  while (*end == ' ' || *end == '\t') ++end;
  if (end == cell.c_str() || *end != '\0' || !std::isfinite(value))
    refuse(file, line_number, "\"" + cell + "\" is no number");
  return value;
}

std::vector<std::string> cells_of(const std::string& text) {
  std::vector<std::string> cells;
  std::istringstream in(text);
  for (std::string cell; std::getline(in, cell, ',');) {
    const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

void check_range(const fs::path& file, std::size_t line_number, const Variable& variable, double value) {
  if (value < variable.minimum || value > variable.maximum)
    refuse(file, line_number,
           line("%s is %g %s, allowed is [%g, %g]", variable.name.c_str(), value, variable.unit.c_str(),
                variable.minimum, variable.maximum));
}

void require_complete(const fs::path& file, const DesignPoint& point) {
  for (std::size_t i = 0; i < point.variables.size(); ++i)
    if (std::isnan(point.variables[i]))
      throw InputError(file.string() + ": variable \"" + contract().variables[i].name +
                       "\" is neither a column nor under \"fixed\" of the study's design");
}

}  // namespace

std::vector<DesignPoint> read_point_csv(const fs::path& file, const std::vector<double>& fixed) {
  const auto lines = lines_of(file);
  std::vector<std::optional<std::size_t>> columns;  // variable of each; nothing: the density
  for (const std::string& name : cells_of(lines.front().second)) {
    if (name == kDensity) {
      columns.emplace_back();
      continue;
    }
    try {
      columns.emplace_back(contract().variable_index(name));
    } catch (const InputError& error) {
      refuse(file, lines.front().first, error.what());
    }
    if (!std::isnan(fixed[*columns.back()]))
      refuse(file, lines.front().first, "\"" + name + "\" is fixed by the study");
  }
  std::vector<DesignPoint> points;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const auto& [number, text] = lines[row];
    const std::vector<std::string> cells = cells_of(text);
    if (cells.size() != columns.size())
      refuse(file, number,
             "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(columns.size()));
    DesignPoint& point = points.emplace_back();
    point.variables = fixed;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double value = number_in(file, number, cells[i]);
      if (!columns[i] && value <= 0) refuse(file, number, "a proposal density is above 0");
      if (columns[i]) check_range(file, number, contract().variables[*columns[i]], value);
      (columns[i] ? point.variables[*columns[i]] : point.proposal_density) = value;
    }
    require_complete(file, point);
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
  for (const auto& [number, text] : lines_of(file)) {
    std::istringstream in(text);
    std::array<double, 5> values{};
    std::string cell;
    for (double& value : values) {
      if (!(in >> cell)) refuse(file, number, "five numbers are needed: slope, radius, density, friction, cohesion");
      value = number_in(file, number, cell);
    }
    if (in >> cell) refuse(file, number, "holds more than five numbers");
    const std::array<double, 2> these{values[1], values[2]};
    if (points.empty()) grains = these;
    if (these != grains)
      refuse(file, number,
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
    require_complete(file, point);
  }
  return points;
}

}  // namespace gonogo::campaign
