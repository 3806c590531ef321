#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "pipeline/cli/command.h"
#include "terrain/soil/calibration.h"

namespace gonogo::pipeline::cli {
namespace {

std::string table(const terrain::Calibration& c) {
  std::string text;
  char line[160];
  for (const terrain::PackingLevel& p : c.packing) {
    std::snprintf(line, sizeof line, "packing settled at friction %.2f: solid fraction %.4f, relative density %.2f\n",
                  p.settle_friction, p.solid_fraction, p.relative_density);
    text += line;
  }
  text += "friction  rolling   friction angle [deg]   cohesion / contact pressure\n";
  for (const terrain::ContactLevel& l : c.contact) {
    std::snprintf(line, sizeof line, "%8.2f %8.2f   %9.2f +- %.2f      %9.3f +- %.3f\n", l.friction, l.rolling_friction,
                  l.friction_angle, l.friction_angle_error, l.cohesion_gain, l.cohesion_gain_error);
    text += line;
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
