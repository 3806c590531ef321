// The table of shipped soils in docs/soils.md, row by row against their files.
#include <algorithm>
#include <filesystem>

#include "base/files/file.h"
#include "base/format.h"
#include "terrain/soil/bearing.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::terrain {
namespace {

const std::filesystem::path kRoot = GONOGO_SOURCE_DIR;

std::string number(const SoilValue& v) {
  return v.fixed() ? line("%.3g", v.low) : line("%.3g", v.low) + " to " + line("%.3g", v.high);
}

/// A source up to its first colon or semicolon: the work, without the row in it.
std::string work(const SoilValue& v) { return v.source.substr(0, v.source.find_first_of(":;")); }

std::string plates(const Calibration& c, const SoilState& s) {
  if (!s.bekker) return "none";
  const auto said = plates_against_strength(s, &c);
  return !said ? "agree" : contains(*said, "at most") ? "too strong" : "too weak";
}

std::string row(const Calibration& c, const std::string& file, const SoilState& s) {
  const MacroscopicSoil triaxial = as_triaxial(c, s.macroscopic());
  return "| `" + file + "`, " + s.name + " | " + s.meaning.text() + (s.meaning.assumed ? " (not named)" : "") + " | " +
         number(s.friction_angle) + ", " + number(s.cohesion) + " | " +
         line("%.1f, %.3g", triaxial.friction_angle, triaxial.cohesion / 1e3) + " | " + plates(c, s) + " | " +
         work(s.friction_angle) + " |";
}

}  // namespace

TEST_CASE("every soil that ships stands in the docs with its test, its strength, what its plates say, and its source") {
  const Calibration c = read_calibration(kRoot / "configs/soils/calibration_32mm.json");
  const std::string page = read_file(kRoot / "docs/soils.md");
  std::size_t rows = 0;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(kRoot / "configs/soils")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const auto& path : files) {
    const std::string name = path.stem().string();
    if (name.rfind("calibration_", 0) == 0) continue;
    CAPTURE(name);
    CHECK(contains(page, "`" + name + "`"));
    if (name == "usda" || name == "uscs") continue;  // ranges of classes, in the table above
    for (const SoilState& s : read_soil(path).states) {
      const std::string expected = row(c, name, s);
      ++rows;
      CHECK_FALSE(s.friction_angle.source.empty());
      CHECK((contains(page, expected) ? "" : expected) == "");  // prints the row that the page lacks
    }
  }
  CHECK(rows == 22);
}

}  // namespace gonogo::terrain
