#include "vehicle/feasible/measured_forces.h"

#include <algorithm>

#include "base/nearest.h"
#include "vehicle/model/assembly.h"

namespace gonogo::vehicle {
namespace {

constexpr double kLargest = 1e9;          // [N]
constexpr double kLeastDeviation = 1e-3;  // [N]

void read_wheel(const Config& wheel, int contact, std::vector<MeasuredForce>& forces) {
  for (int component = 0; component < 3; ++component) {
    const auto given = wheel.object_if(kForceComponent[component]);
    if (!given) continue;
    forces.push_back({.contact = contact,
                      .component = component,
                      .force = given->number("force_N", {-kLargest, kLargest}),
                      .deviation = given->number("deviation_N", {kLeastDeviation, kLargest})});
    given->finish();
  }
  wheel.finish();
}

}  // namespace

std::vector<MeasuredForce> read_measured_forces(const std::filesystem::path& path, const Vehicle& v) {
  std::vector<std::string> names;
  for (const Station& s : stations(v)) names.push_back(s.name);
  const Config file = Config::read(path);
  const Config wheels = file.object("wheels");
  file.finish();
  std::vector<MeasuredForce> forces;
  for (const auto& [name, wheel] : wheels.members()) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) wheels.fail(name, v.name + " has no such wheel; it has: " + join_words(names));
    read_wheel(wheel, int(found - names.begin()), forces);
  }
  if (forces.empty()) wheels.fail("", "no force is measured; give at least one component of one wheel");
  return forces;
}

}  // namespace gonogo::vehicle
