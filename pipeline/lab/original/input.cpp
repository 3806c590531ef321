#include "pipeline/lab/original/input.h"

#include <fstream>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "base/line.h"
#include "base/units.h"

namespace gonogo::lab {
namespace {

struct Column {
  const char* name;
  const char* unit;
  double min, max;
};

/// Wider than what the study sampled: slopes of 0 to 30 degrees, radii of 4 to 30 mm, densities of 1000 to 3000 kg/m^3,
/// friction of 0.2 to 1 and cohesion of 1 to 1000 kPa.
constexpr Column kColumn[] = {{"slope", "deg", -45, 45},
                              {"grain radius", "mm", 0.5, 100},
                              {"density", "kg/m^3", 100, 20000},
                              {"friction", "-", 0, 3},
                              {"cohesion", "kPa", 0, 10000}};

std::vector<double> numbers_of(const std::string& text, const std::string& where) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (*end != 0) throw InputError(where + line(": \"%s\" is not a number", word.c_str()));
  }
  if (numbers.size() != std::size(kColumn))
    throw InputError(where + " has " + std::to_string(numbers.size()) +
                     " numbers; a run has five: slope [deg], grain radius [mm], density [kg/m^3], friction, cohesion "
                     "[kPa]");
  return numbers;
}

}  // namespace

OriginalInput read_original_input(const std::filesystem::path& file, int line) {
  std::ifstream in(file);
  if (!in) throw InputError(file.string() + ": cannot be read");
  std::string text;
  int count = 0;
  while (count < line && std::getline(in, text)) ++count;
  if (line < 1 || count < line)
    throw InputError(file.string() + " has " + std::to_string(count) + " lines, none with the number " +
                     std::to_string(line) + "; lines count from 1");
  const std::string where = file.string() + ", line " + std::to_string(line);
  const std::vector<double> x = numbers_of(text, where);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!(x[i] >= kColumn[i].min && x[i] <= kColumn[i].max))
      throw InputError(
          where + ": " + kColumn[i].name +
          gonogo::line(" %g %s; allowed are %g to %g", x[i], kColumn[i].unit, kColumn[i].min, kColumn[i].max));
  return {.slope = to_radians(x[0]), .radius = 1e-3 * x[1], .density = x[2], .friction = x[3], .cohesion = 1e3 * x[4]};
}

}  // namespace gonogo::lab
