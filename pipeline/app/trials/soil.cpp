#include <map>
#include <memory>
#include <string>

#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "base/units.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/numerics_options.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/inspect/soil_library.h"
#include "pipeline/inspect/soil_numbers.h"
#include "pipeline/inspect/soil_tests.h"
#include "terrain/soil/soil.h"
#include "terrain/soil_test/calibrate.h"

namespace gonogo::app {

namespace {

/// Gradients of cone indices, one row for each contact level; empty for a table without cones.
std::string cone_rows(const terrain::Calibration& c) {
  std::string text;
  for (std::size_t k = 0; k < c.contact.size(); ++k) {
    std::string row;
    for (std::size_t p = 0; p < c.packing.size(); ++p) {
      const terrain::SoilResponse& r = c.response[k * c.packing.size() + p];
      if (r.cone_gradient > 0) row += line("  %6.1f +- %-5.1f", r.cone_gradient, r.cone_gradient_error);
    }
    if (!row.empty()) text += line("%8.2f %8.2f ", c.contact[k].friction, c.contact[k].rolling_friction) + row + "\n";
  }
  return text.empty() ? text : "gradient of the cone index over unit weight, by packing\n" + text;
}

std::string table(const terrain::Calibration& c) {
  std::string text;
  for (const terrain::PackingLevel& p : c.packing) {
    text += line("packing settled at friction %.2f: solid fraction %.4f, relative density %.2f\n", p.settle_friction,
                 p.solid_fraction, p.relative_density);
  }
  const std::size_t packings = c.packing.size();
  text += "                    friction angle [deg], mean over packings\n";
  text +=
      "friction  rolling   triaxial peak   shear plane: peak, steady   cohesion / contact pressure   loosest solid "
      "fraction\n";
  for (std::size_t k = 0; k < c.contact.size(); ++k) {
    const terrain::ContactLevel& l = c.contact[k];
    double peak = 0, steady = 0;
    for (std::size_t p = 0; p < packings; ++p) {
      peak += c.response[k * packings + p].shear_peak.degrees / double(packings);
      steady += c.response[k * packings + p].shear_steady.degrees / double(packings);
    }
    text += line("%8.2f %8.2f   %5.2f +- %.2f            %5.2f, %5.2f            %9.3f +- %.3f          %9.4f\n",
                 l.friction, l.rolling_friction, l.friction_angle, l.friction_angle_error, peak, steady,
                 l.cohesion_gain, l.cohesion_gain_error, l.loosest_solid_fraction);
  }
  return text + cone_rows(c);
}

int thread_count(const Globals& globals) { return threads_or_all(globals.threads); }

void add_shape(CLI::App& command, terrain::GrainShape& shape) {
  command
      .add_option_function<std::string>(
          "--shape", [&shape](const std::string& name) { shape = terrain::grain_shape_of(name); },
          "Grains: spheres, or clumps of two (pair) or three (trefoil) with the volume of a sphere; default: sphere")
      ->check(CLI::IsMember(terrain::grain_shape_names()));
}

/// Options of all tests.
void add_soil_options(CLI::App& command, inspect::SoilTestRequest& r) {
  const auto real = [](Real& target, double scale) { return [&target, scale](double x) { target = Real(x * scale); }; };
  command.add_option("--grain", r.soil.grain_diameter, "Grain diameter [m]")->capture_default_str();
  add_shape(command, r.soil.shape);
  command.add_option_function<double>("--friction", real(r.soil.grain.friction, 1),
                                      "Sliding friction of grains [-]; default: 0.5");
  command.add_option_function<double>("--rolling", real(r.soil.grain.rolling_friction, 1),
                                      "Rolling friction of grains [effective radii]; default: 0");
  command.add_option_function<double>("--cohesion", real(r.soil.grain.cohesion_pressure, 1e3),
                                      "Cohesion pressure between grains, not of the soil [kPa]; default: 0");
  command.add_option("--tool-friction", r.soil.tool_friction, "Friction of grains on plate, cone and walls")
      ->capture_default_str();
  command.add_option("--density", r.soil.relative_density, "Relative density, 0 loosest to 1 densest")
      ->capture_default_str();
  command.add_option("--grain-density", r.soil.grain_density, "Density of the grains' solid [kg/m3]")
      ->capture_default_str();
  command.add_option("--seed", r.soil.seed, "First seed")->check(kSeed)->capture_default_str();
  add_number(command, "--seeds", r.seeds, {1, 100}, "Packings, one per seed");
  add_choice(command, "--device", r.device, kBackends, "Device that computes the tests, on cuda all in one batch");
  command.add_flag("--quick", r.quick, "Smaller beds and shorter paths, for a first look");
}

void add_test(CLI::App& parent, const Globals& globals, const std::string& name, const std::string& about) {
  CLI::App* command = parent.add_subcommand(name, about);
  const auto request = std::make_shared<inspect::SoilTestRequest>();
  const auto out = std::make_shared<std::string>();
  const auto stresses = std::make_shared<std::vector<double>>();
  const auto numerics = std::make_shared<terrain::Numerics>();
  add_soil_options(*command, *request);
  add_numerics_options(*command, *numerics, "Trials");
  if (name == "shear" || name == "triaxial")
    command->add_option(
        "--stress", *stresses,
        name == "shear" ? "Normal stresses [kPa]; default: 5 10 20" : "Confining stresses [kPa]; default: 5 10 20");
  if (name == "shear" || name == "triaxial")
    command
        ->add_option("--inertial-number", request->inertial_number,
                     "Shear or strain rate times d sqrt(solid density / stress); default: 0.006, below 0.01: slow")
        ->check(CLI::Range(1e-6, 1.0));
  if (name == "plate")
    command->add_option("--widths", request->plate_widths, "Plate widths [grain diameters]")->capture_default_str();
  if (name == "cone")
    command->add_option("--cone", request->cone_diameter, "Diameter of the cone's base [grain diameters]")
        ->capture_default_str();
  add_named(*command, "--out", *out, kFolder,
            "Folder for curves (CSV, PNG), a picture of the grains, and the numbers (JSON)");
  add_examples(*command,
               {"gonogo soil test " + name + " --grain 0.032 --friction 0.5 --rolling 0.1 --out out/" + name});
  command->callback([&globals, name, command, request, out, stresses, numerics] {
    if (numerics_given(*command)) request->numerics = *numerics;
    request->threads = thread_count(globals);
    request->soil.packing_folder = campaign::default_packing_folder();
    if (!stresses->empty()) request->stresses.clear();
    for (const double s : *stresses) request->stresses.push_back(s * 1e3);
    const inspect::SoilTestOutcome o = inspect::run_soil_test(name, *request);
    if (!out->empty()) inspect::write_soil_test(*out, o, request->threads);
    print_result(globals, as_json(o), as_text(o) + (out->empty() ? "" : "written to " + *out + "\n"));
  });
}

void add_tests(CLI::App& soil, const Globals& globals) {
  CLI::App* test = soil.add_subcommand("test", "Virtual soil tests: curves, pictures and derived numbers");
  test->require_subcommand(1);
  add_examples(*test, {"gonogo soil test shear --grain 0.032 --friction 0.5 --rolling 0.1 --out out/shear"});
  add_test(*test, globals, "repose", "Angle of repose behind a wall that is lowered");
  add_test(*test, globals, "shear", "Friction angle and cohesion from simple shear under several loads");
  add_test(*test, globals, "plate", "Bekker's k_c, k_phi and n from plates of several widths");
  add_test(*test, globals, "cone", "Cone index and its gradient");
  add_test(*test, globals, "triaxial", "Friction angle and cohesion from compression between smooth platens");
}

/// The table that cones are added to, whose grains and numerics the run takes.
terrain::Calibration table_for_cones(const CLI::App& command, const std::string& file, int cones,
                                     terrain::CalibrationRun& run) {
  if (cones == 0) throw InputError("soil calibrate: --onto adds cones to a table; say how many with --cones, 1 to 50");
  for (const char* other : {"--grain", "--shape", "--seeds", "--angle-seeds", "--friction"})
    if (command.count(other) > 0)
      throw InputError(std::string("soil calibrate: --onto takes grains and levels from its table; leave out ") +
                       other);
  terrain::Calibration table = terrain::read_calibration(file);
  run.grain_diameter = table.grain_diameter;
  run.shape = table.shape;
  if (!numerics_given(command)) run.numerics = terrain::numerics_by_table(table, file);
  return table;
}

void add_calibrate(CLI::App& soil, const Globals& globals) {
  CLI::App* command = soil.add_subcommand(
      "calibrate", "Measure friction angle, cohesion, density and sinkage modulus of a grain size by virtual tests");
  const auto run = std::make_shared<terrain::CalibrationRun>();
  const auto out = std::make_shared<std::string>();
  add_number(*command, "--grain", run->grain_diameter, {0.001, 0.5}, "Grain diameter [m]");
  add_shape(*command, run->shape);
  add_number(*command, "--seeds", run->seeds, {1, 50}, "Packings of each density");
  add_number(*command, "--angle-seeds", run->angle_seeds, {1, 50},
             "Packings of each density whose friction angle is measured, cohesion and plates with --seeds of them");
  command->add_option("--friction", run->friction_range,
                      "Min and max sliding friction of the contact levels, for a table of a narrow range of soils");
  const auto cones = std::make_shared<int>(0);
  const auto onto = std::make_shared<std::string>();
  add_number(*command, "--cones", *cones, {0, 50}, "Packings of each density into which cones are pressed");
  add_named(*command, "--onto", *onto, kFile, "With --cones: table to which they are added; nothing else is measured");
  const auto keep = std::make_shared<bool>(false);
  command->add_flag(
      "--keep-tests", *keep,
      "Keep the tests (OUT.tests) beside the finished table, for a run with more seeds or levels to continue");
  add_choice(*command, "--device", run->device, kBackends, "Device that computes the tests, on cuda all in one batch");
  add_numerics_options(*command, run->numerics, "Trials");
  add_named(*command, "--out", *out, kFile, "Table to write (JSON); finished tests are kept beside it until it is done")
      ->required();
  add_examples(*command,
               {"gonogo soil calibrate --grain 0.032 --out configs/soils/calibration_32mm.json",
                "gonogo soil calibrate --onto configs/soils/calibration_32mm.json --cones 4 --out with_cones.json",
                "gonogo soil calibrate --friction 0.5 0.7 --substeps 10 --iterations 20 --out dense_sand.json"});
  command->callback([&globals, command, run, out, keep, cones, onto] {
    if (!numerics_given(*command)) run->numerics = terrain::usual_numerics(run->grain_diameter);
    run->threads = thread_count(globals);
    run->journal = *out + ".tests";
    terrain::Calibration c = onto->empty() ? terrain::calibrate(*run) : table_for_cones(*command, *onto, *cones, *run);
    if (*cones > 0) {
      run->seeds = *cones;
      terrain::add_cones(c, *run);
    }
    terrain::write_calibration(*out, c);
    if (!*keep) std::filesystem::remove(run->journal);
    Json json;
    json["table"] = *out;
    json["grain_diameter_m"] = run->grain_diameter;
    json["shape"] = terrain::name_of(run->shape);
    json["lowest_friction_angle_deg"] = terrain::reachable_angles(c).lowest;
    json["highest_friction_angle_deg"] = terrain::reachable_angles(c).highest;
    print_result(globals, json, table(c) + "written to " + *out + "\n");
  });
}

void add_library(CLI::App& soil, const Globals& globals) {
  CLI::App* list = soil.add_subcommand("list", "Soils in configs/soils and their states");
  add_examples(*list, {"gonogo soil list"});
  list->callback([&globals] {
    const inspect::SoilReport r = inspect::list_soils();
    print_result(globals, r.json, r.text);
  });
  CLI::App* show = soil.add_subcommand("show", "Numbers of a soil with their sources, and how close grains come to it");
  const auto name = std::make_shared<std::string>(), calibration = std::make_shared<std::string>();
  add_named(*show, "soil", *name, kSoil, "Soil")->required();
  add_named(*show, "--calibration", *calibration, kFile,
            "Calibration of a grain size: contact laws and mismatch for this soil");
  add_examples(*show, {"gonogo soil show sandy_loam --calibration configs/soils/calibration_90mm.json"});
  show->callback([&globals, name, calibration] {
    const inspect::SoilReport r = inspect::show_soil(inspect::soil_file(*name), *calibration);
    print_result(globals, r.json, r.text);
  });
  CLI::App* fit = soil.add_subcommand(
      "fit", "Weigh all tests of a soil, and write into its file how close the grains of a table come to it");
  const auto file = std::make_shared<std::string>(), with = std::make_shared<std::string>();
  const auto stress = std::make_shared<double>(0);
  fit->add_option(
         "--stress", *stress,
         "Normal stress at which the strength acts [kPa], such as a wheel's load over its contact; default: as tested")
      ->check(CLI::Range(0.01, 1e4));
  add_named(*fit, "soil", *file, kSoil, "Soil")->required();
  add_named(*fit, "--calibration", *with, kFile, "Calibration of a grain size")->required();
  add_examples(*fit, {"gonogo soil fit sandy_loam --calibration configs/soils/calibration_32mm.json"});
  fit->callback([&globals, file, with, stress] {
    const std::filesystem::path path = inspect::soil_file(*file);
    terrain::write_fits(path, std::filesystem::path(*with).filename().string(), terrain::read_calibration(*with));
    inspect::SoilReport r = inspect::show_soil(path, *with);
    const inspect::SoilReport all = inspect::weigh_evidence(path, *with, 1e3 * *stress);
    r.json["posterior"] = all.json;
    print_result(globals, r.json, r.text + "\n" + all.text + "written to " + path.string() + "\n");
  });
}

void add_cone(CLI::App& soil, const Globals& globals) {
  CLI::App* from = soil.add_subcommand("from-cone", "Strength of fine-grained soil by its cone index");
  const auto index = std::make_shared<double>(0), angle = std::make_shared<double>(-1);
  const auto unit = std::make_shared<double>(kPsi);  // [Pa]
  from->add_option("index", *index, "Cone index or rating cone index")->required()->check(CLI::Range(0.0, 6000.0));
  add_choice(*from, "--unit", *unit, std::map<std::string, double>{{"psi", kPsi}, {"kPa", 1e3}}, "Unit of the index");
  from->add_option("--friction-angle", *angle, "Friction angle of triaxial compression [deg]; default: several")
      ->check(CLI::Range(0.0, 45.0));
  add_examples(*from, {"gonogo soil from-cone 60 --friction-angle 15"});
  from->callback([&globals, index, angle, unit] {
    const inspect::SoilReport r = inspect::strength_of_cone(*index * *unit, *angle);
    print_result(globals, r.json, r.text);
  });
  CLI::App* to = soil.add_subcommand("to-cone", "Cone index of the fine-grained states of a soil");
  const auto name = std::make_shared<std::string>();
  add_named(*to, "soil", *name, kSoil, "Soil")->required();
  add_examples(*to, {"gonogo soil to-cone lean_clay"});
  to->callback([&globals, name] {
    const inspect::SoilReport r = inspect::cone_of_soil(inspect::soil_file(*name));
    print_result(globals, r.json, r.text);
  });
}

void add_soil_export(CLI::App& soil, const Globals& globals) {
  CLI::App* command = soil.add_subcommand(
      "export", "Numbers of soft-soil models with errors, from plate and shear tests of a soil's calibrated grains");
  const auto r = std::make_shared<inspect::SoilNumbersRequest>();
  const auto name = std::make_shared<std::string>(), table = std::make_shared<std::string>("calibration_32mm"),
             format = std::make_shared<std::string>("bekker"), out = std::make_shared<std::string>();
  add_named(*command, "soil", *name, kSoil, "Soil")->required();
  command->add_option("--state", r->state, "State of the soil; default: its first");
  add_named(*command, "--calibration", *table, kTable, "Table of the grains")->capture_default_str();
  command->add_option("--format", *format, "bekker: n, k_c, k_phi, c, phi, K; scm: arguments of Project Chrono's SCM")
      ->check(CLI::IsMember({"bekker", "scm"}))
      ->capture_default_str();
  command->add_option("--grain", r->grain, "Grain diameter [m]; default: the table's")->check(CLI::Range(0.0005, 0.2));
  command->add_option("--widths", r->plate_widths, "Plate widths [grain diameters]")->capture_default_str();
  add_number(*command, "--seeds", r->seeds, {1, 100}, "Packings of each test");
  command->add_flag("--quick", r->quick, "Smaller beds and shorter paths, for a first look");
  add_named(*command, "--out", *out, kFile, "JSON to write; default: it is printed");
  add_examples(*command, {"gonogo soil export ding2011 --format scm --out out/ding2011_scm.json"});
  command->callback([&globals, r, name, table, format, out] {
    r->soil = inspect::soil_file(*name);
    r->calibration = shipped_file("soils", "calibration", *table);
    r->threads = threads_or_all(globals.threads);
    const inspect::SoilNumbers numbers = inspect::measure_soil_numbers(*r);
    const Json json = inspect::numbers_json(numbers, *format);
    if (!out->empty()) write_file_atomically(*out, json.dump(2) + "\n");
    print_result(globals, json, inspect::numbers_text(numbers) + (out->empty() ? "" : "written to " + *out + "\n"));
  });
}

}  // namespace

void add_soil_command(CLI::App& app, const Globals& globals) {
  CLI::App* soil = app.add_subcommand("soil", "Virtual soil tests and calibration");
  soil->require_subcommand(1);
  add_examples(*soil, {"gonogo soil test shear --grain 0.032 --friction 0.5 --rolling 0.1"});
  add_tests(*soil, globals);
  add_calibrate(*soil, globals);
  add_library(*soil, globals);
  add_cone(*soil, globals);
  add_soil_export(*soil, globals);
}

}  // namespace gonogo::app
