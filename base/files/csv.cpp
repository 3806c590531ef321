#include "base/files/csv.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"

namespace gonogo {

std::vector<std::string> CsvLine::cells() const {
  std::vector<std::string> cells;
  std::istringstream in(text);
  for (std::string cell; std::getline(in, cell, ',');) {
    const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

std::vector<CsvLine> read_csv_lines(const std::filesystem::path& file, const std::string& rows) {
  std::istringstream in(read_file(file));
  std::vector<CsvLine> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::size_t first = text.find_first_not_of(" \t");
    if (first != std::string::npos && text[first] != '#') lines.push_back({number, text});
  }
  if (lines.empty()) throw InputError(file.string() + ": holds no " + rows);
  return lines;
}

void refuse_csv_line(const std::filesystem::path& file, std::size_t number, const std::string& what) {
  throw InputError(file.string() + ": line " + std::to_string(number) + ": " + what);
}

double csv_number(const std::filesystem::path& file, std::size_t number, const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  while (*end == ' ' || *end == '\t') ++end;
  if (end == cell.c_str() || *end != '\0' || !std::isfinite(value))
    refuse_csv_line(file, number, "\"" + cell + "\" is no number");
  return value;
}

}  // namespace gonogo
