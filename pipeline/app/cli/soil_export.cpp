#include <memory>

#include "base/cores.h"
#include "base/file.h"
#include "base/shipped.h"
#include "pipeline/app/cli/soil_parts.h"
#include "pipeline/lab/soil/library.h"
#include "pipeline/lab/soil/soil_numbers.h"

namespace gonogo::app {

void add_soil_export(CLI::App& soil, const Globals& globals) {
  CLI::App* command = soil.add_subcommand(
      "export", "Numbers of soft-soil models with errors, from plate and shear tests of a soil's calibrated grains");
  const auto r = std::make_shared<lab::SoilNumbersRequest>();
  const auto name = std::make_shared<std::string>(), table = std::make_shared<std::string>("calibration_32mm"),
             format = std::make_shared<std::string>("bekker"), out = std::make_shared<std::string>();
  command->add_option("soil", *name, "Soil")->type_name(kSoil)->required();
  command->add_option("--state", r->state, "State of the soil; default: its first");
  command->add_option("--calibration", *table, "Table of the grains")->type_name(kTable)->capture_default_str();
  command->add_option("--format", *format, "bekker: n, k_c, k_phi, c, phi, K; scm: arguments of Project Chrono's SCM")
      ->check(CLI::IsMember({"bekker", "scm"}))
      ->capture_default_str();
  command->add_option("--grain", r->grain, "Grain diameter [m]; default: the table's")->check(CLI::Range(0.0005, 0.2));
  command->add_option("--widths", r->plate_widths, "Plate widths [grain diameters]")->capture_default_str();
  command->add_option("--seeds", r->seeds, "Packings of each test")->check(CLI::Range(1, 100))->capture_default_str();
  command->add_flag("--quick", r->quick, "Smaller beds and shorter paths, for a first look");
  command->add_option("--out", *out, "JSON to write; default: it is printed")->type_name(kFile);
  add_examples(*command, {"gonogo soil export ding2011 --format scm --out out/ding2011_scm.json"});
  command->callback([&globals, r, name, table, format, out] {
    r->soil = lab::soil_file(*name);
    r->calibration = shipped_file("soils", "calibration", *table);
    r->threads = threads_or_all(globals.threads);
    const lab::SoilNumbers numbers = lab::measure_soil_numbers(*r);
    const Json json = lab::numbers_json(numbers, *format);
    if (!out->empty()) write_file_atomically(*out, json.dump(2) + "\n");
    print_result(globals, json, lab::numbers_text(numbers) + (out->empty() ? "" : "written to " + *out + "\n"));
  });
}

}  // namespace gonogo::app
