#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/nearest.h"
#include "base/words.h"
#include "pipeline/lab/wheels/benchmark.h"

namespace gonogo::lab {
namespace {

struct Column {
  Quantity quantity;
  const char *name, *column, *unit;
};
constexpr std::array<Column, 9> kColumns{{{Quantity::slip, "slip", "slip", ""},
                                          {Quantity::slope, "slope", "slope_deg", "deg"},
                                          {Quantity::slip_angle, "slip_angle", "slip_angle_deg", "deg"},
                                          {Quantity::load, "load", "load_N", "N"},
                                          {Quantity::pull, "pull", "pull_N", "N"},
                                          {Quantity::traction_slope, "traction_slope", "traction_slope_deg", "deg"},
                                          {Quantity::side_force, "side_force", "side_force_N", "N"},
                                          {Quantity::torque, "torque", "torque_N_m", "N m"},
                                          {Quantity::sinkage, "sinkage", "sinkage_m", "m"}}};

const Column& entry(Quantity q) { return kColumns[std::size_t(q)]; }

using Row = std::map<Quantity, double>;

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const std::size_t first = cell.find_first_not_of(" \t\r"), last = cell.find_last_not_of(" \t\r");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

[[noreturn]] void refuse(const std::filesystem::path& file, std::size_t number, const std::string& what) {
  throw InputError(file.string() + ": line " + std::to_string(number) + ": " + what);
}

Quantity quantity_of_column(const std::filesystem::path& file, const std::string& column) {
  std::vector<std::string> known;
  for (const Column& c : kColumns) {
    if (column == c.column) return c.quantity;
    if (column == c.name) refuse(file, 1, "column \"" + column + "\" has no unit; write " + c.column);
    known.emplace_back(c.column);
  }
  refuse(file, 1, "column \"" + column + "\" is not known; columns are " + join_words(known));
}

double number_in(const std::filesystem::path& file, std::size_t number, const std::string& cell) {
  char* end = nullptr;
  const double x = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0' || !std::isfinite(x)) refuse(file, number, "\"" + cell + "\" is no number");
  return x;
}

std::vector<Row> rows_of(const std::filesystem::path& file) {
  std::istringstream in(read_file(file));
  std::string text;
  std::getline(in, text);
  std::vector<Quantity> header;
  for (const std::string& column : cells_of(text)) header.push_back(quantity_of_column(file, column));
  std::vector<Row> rows;
  for (std::size_t number = 2; std::getline(in, text); ++number) {
    const std::vector<std::string> cells = cells_of(text);
    if (cells.empty()) continue;
    if (cells.size() != header.size())
      refuse(file, number,
             "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(header.size()));
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!row.emplace(header[i], number_in(file, number, cells[i])).second)
        refuse(file, 1, std::string("column \"") + column_of(header[i]) + "\" stands there twice");
  }
  if (rows.empty()) throw InputError(file.string() + ": holds no points; write a header and a row for each");
  return rows;
}

BenchmarkPoint point_of(const std::vector<Row>& repeats, const std::vector<Quantity>& led) {
  BenchmarkPoint p;
  for (const auto& [quantity, first] : repeats.front()) {
    if (std::find(led.begin(), led.end(), quantity) != led.end()) {
      p.led[quantity] = first;
      continue;
    }
    Measured m{0, first, first, int(repeats.size())};
    for (const Row& r : repeats) {
      const double x = r.at(quantity);
      m.mean += x / double(repeats.size());
      m.low = std::min(m.low, x);
      m.high = std::max(m.high, x);
    }
    if (quantity == Quantity::load)
      p.led[quantity] = m.mean;
    else
      p.measured[quantity] = m;
  }
  return p;
}

}  // namespace

const char* name_of(Quantity q) { return entry(q).name; }
const char* column_of(Quantity q) { return entry(q).column; }
const char* unit_of(Quantity q) { return entry(q).unit; }

Quantity quantity_named(const std::string& name, const Config& where, const std::string& key) {
  std::vector<std::string> known;
  for (const Column& c : kColumns) {
    if (name == c.name) return c.quantity;
    known.emplace_back(c.name);
  }
  where.fail(key, "\"" + name + "\" is no quantity; there are " + join_words(known));
}

std::vector<BenchmarkPoint> read_points(const std::filesystem::path& file, const std::vector<Quantity>& led) {
  const std::vector<Row> rows = rows_of(file);
  for (const Quantity q : led)
    if (!rows.front().count(q))
      throw InputError(file.string() + ": has no column \"" + column_of(q) + "\", which is led");
  const auto together = [&](const Row& a, const Row& b) {
    return std::all_of(led.begin(), led.end(), [&](Quantity q) { return a.at(q) == b.at(q); });
  };
  std::vector<std::vector<Row>> groups;
  for (const Row& row : rows) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return together(g.front(), row); });
    if (group == groups.end()) group = groups.insert(groups.end(), std::vector<Row>{});
    group->push_back(row);
  }
  std::vector<BenchmarkPoint> points;
  for (const auto& repeats : groups) points.push_back(point_of(repeats, led));
  return points;
}

}  // namespace gonogo::lab
