#include <memory>

#include "base/cores.h"
#include "base/shipped.h"
#include "pipeline/app/cli/validate_parts.h"
#include "pipeline/lab/validate/soils.h"

namespace gonogo::app {
namespace {

struct SoilsRequest {
  std::vector<std::string> figures;
  std::string folder;
  lab::SoilValidation tests;
};

void validate_soils(const Globals& globals, SoilsRequest& request) {
  request.tests.threads = threads_or_all(globals.threads);
  report_figures(globals, request.figures, request.folder, "soils",
                 [&](const std::string& name) { return lab::soil_figure(name, request.tests); });
}

}  // namespace

void add_soils_check(CLI::App& validate, const Globals& globals) {
  CLI::App* soils =
      validate.add_subcommand("soils", "Soil tests, and soils through the calibration; fails when a bound is not kept");
  auto request = std::make_shared<SoilsRequest>();
  request->figures = lab::soil_figures();
  const std::vector<std::string> all = request->figures;
  auto calibration = std::make_shared<std::string>("calibration_90mm");
  auto seeds = std::make_shared<int>(2);
  soils->add_option("figures", request->figures, "Figures to make; default: all")->check(CLI::IsMember(all));
  soils->add_option("--calibration", *calibration, "Table of the grains to be tested")
      ->type_name(kTable)
      ->capture_default_str();
  soils->add_option("--seeds", *seeds, "Beds for each test")->check(CLI::Range(1, 100))->capture_default_str();
  soils->add_flag("--quick", request->tests.quick, "Smaller beds and shorter paths, for a first look");
  soils->add_option("--out", request->folder, "Folder for a figure and a table of each")->type_name(kFolder);
  add_examples(*soils, {"gonogo validate soils shear triaxial --out docs/validation --json"});
  soils->callback([&globals, request, calibration, seeds] {
    request->tests.calibration = shipped_file("soils", "calibration", *calibration);
    request->tests.seeds = *seeds;
    validate_soils(globals, *request);
  });
}

}  // namespace gonogo::app
