#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "pipeline/cli/command.h"
#include "terrain/soil/calibration.h"

namespace gonogo::pipeline::cli {
namespace {

std::string table(const terrain::Calibration& c) {
  std::string text = "grain " + std::to_string(c.grain_diameter) + " m\nfriction  rolling";
  char cell[64];
  for (const terrain::PackingLevel& p : c.packing) {
    std::snprintf(cell, sizeof cell, "   angle at density %.2f", p.relative_density);
    text += cell;
  }
  text += "   cohesion gain\n";
  for (const terrain::ContactLevel& l : c.contact) {
    std::snprintf(cell, sizeof cell, "%8.2f %8.2f", l.friction, l.rolling_friction);
    text += cell;
    for (std::size_t p = 0; p < c.packing.size(); ++p) {
      std::snprintf(cell, sizeof cell, "   %7.2f +- %.2f deg   ", l.friction_angle[p], l.friction_angle_error[p]);
      text += cell;
    }
    std::snprintf(cell, sizeof cell, "   %.3f +- %.3f\n", l.cohesion_gain, l.cohesion_gain_error);
    text += cell;
  }
  return text;
}

}  // namespace

void add_soil_command(CLI::App& app, const Globals& globals) {
  CLI::App* soil = app.add_subcommand("soil", "Virtual soil tests and calibration");
  soil->require_subcommand(1);
  soil->footer("Example:\n  gonogo soil calibrate --grain 0.08 --out configs/soils/calibration_80mm.json");
  CLI::App* command = soil->add_subcommand(
      "calibrate", "Measure friction angle, cohesion and density for a grain size by virtual shear tests");
  auto grain = std::make_shared<double>(0.08);
  auto out = std::make_shared<std::string>();
  command->add_option("--grain", *grain, "Grain diameter [m]")->check(CLI::Range(0.001, 0.5));
  command->add_option("--out", *out, "Table to write (JSON)")->required();
  command->footer("Example:\n  gonogo soil calibrate --grain 0.08 --out configs/soils/calibration_80mm.json");
  command->callback([&globals, grain, out] {
    const int threads = globals.threads > 0 ? globals.threads : int(std::thread::hardware_concurrency());
    const terrain::Calibration c = terrain::calibrate(*grain, threads);
    terrain::write_calibration(*out, c);
    Json json;
    json["table"] = *out;
    json["grain_diameter_m"] = *grain;
    json["lowest_friction_angle_deg"] = terrain::reachable_angles(c).lowest;
    json["highest_friction_angle_deg"] = terrain::reachable_angles(c).highest;
    print_result(globals, json, table(c) + "written to " + *out + "\n");
  });
}

}  // namespace gonogo::pipeline::cli
