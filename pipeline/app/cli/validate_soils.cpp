#include <memory>

#include "base/cancel.h"
#include "base/cores.h"
#include "base/shipped.h"
#include "pipeline/app/cli/numerics_options.h"
#include "pipeline/app/cli/validate_parts.h"
#include "pipeline/lab/validate/given_slip.h"
#include "pipeline/lab/validate/slope_slip.h"
#include "pipeline/lab/validate/soils.h"

namespace gonogo::app {
namespace {

struct SoilsRequest {
  std::vector<std::string> figures;
  std::string folder;
  lab::SoilValidation tests;
  lab::SimulantRun wheel;
};

lab::SoilFigure figure_of(const std::string& name, SoilsRequest& request, int threads) {
  request.tests.threads = request.wheel.threads = threads;
  request.wheel.vehicle = name == "mgru3_rover" ? lab::kSimulantRover : lab::kSimulantWheel;
  if (name == "mgru3" || name == "mgru3_rover")
    return lab::slope_slip_figure(request.wheel, lab::run_slope_slip(request.wheel));
  if (name == "trec") return lab::given_slip_figure(request.wheel, lab::run_given_slips(request.wheel));
  return lab::soil_figure(name, request.tests);
}

void validate_soils(const Globals& globals, SoilsRequest& request) {
  const int threads = threads_or_all(globals.threads);
  Json json = Json::object(), checks = Json::object();
  std::string text;
  int failed = 0;
  for (const std::string& name : request.figures) {
    stop_if_cancelled();
    const lab::SoilFigure figure = figure_of(name, request, threads);
    if (!request.folder.empty()) lab::write_figure(request.folder, figure);
    text += lab::as_text(figure);
    for (const lab::SoilCheck& c : figure.check) {
      json[c.key] = c.measured;
      failed += !c.holds();
    }
    checks[name] = lab::as_json(figure);
  }
  json["failed"] = failed;
  json["checks"] = checks;
  if (failed > 0)
    fail_with_result(globals, json, text, DeviceError(std::to_string(failed) + " checks of soils do not hold"));
  print_result(globals, json, text);
}

/// Options of the figures with a wheel or the rover on a simulant.
void add_wheel_options(CLI::App& soils, lab::SimulantRun& wheel) {
  CLI::App& of = *soils.add_option_group("mgru3, mgru3_rover, trec", "A wheel or the rover on a lunar simulant");
  add_asked_numerics_options(of, wheel.numerics, "Trials");
  of.add_option("--grain", wheel.grain, "Grain diameter [m]; default: the table's")->check(CLI::Range(0.002, 0.2));
  of.add_option("--depth", wheel.depth, "Depth of the bed [m]")->check(CLI::Range(0.05, 2.0))->capture_default_str();
  of.add_option("--length", wheel.length, "Length of the bed [m]; default: 2, for the rover 3.5")
      ->check(CLI::Range(0.5, 20.0));
  of.add_option("--width", wheel.width, "Width of the bed [m]; default: 0.7, for the rover two thirds of its track")
      ->check(CLI::Range(0.3, 10.0));
  of.add_option("--time", wheel.time, "Time driven [s], of which the last half counts; default: 8, for the rover 24")
      ->check(CLI::Range(1.0, 100.0));
  of.add_option("--wheel-friction", wheel.wheel_friction, "Friction of grains on the wheels [-]")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
  of.add_option("--state", wheel.state, "State of configs/soils/grc1.json (trec: grc3.json); default: the first");
  of.add_flag("--gpu", wheel.gpu, "Run on the GPU");
}

}  // namespace

void add_soils_check(CLI::App& validate, const Globals& globals) {
  CLI::App* soils = validate.add_subcommand(
      "soils",
      "Soil tests, soils through the calibration, a wheel and a rover on slopes; fails when a bound is not kept");
  auto request = std::make_shared<SoilsRequest>();
  request->figures = lab::soil_figures();
  request->figures.insert(request->figures.end(), {"mgru3", "mgru3_rover", "trec"});
  const std::vector<std::string> all = request->figures;
  auto calibration = std::make_shared<std::string>("calibration_90mm"), wheel = std::make_shared<std::string>();
  auto seeds = std::make_shared<int>(2);
  soils->add_option("figures", request->figures, "Figures to make; default: all")->check(CLI::IsMember(all));
  soils->add_option("--calibration", *calibration, "Table of the grains to be tested")
      ->type_name(kTable)
      ->capture_default_str();
  soils
      ->add_option("--wheel-calibration", *wheel,
                   "Table of the grains of mgru3, mgru3_rover and trec; default: the same")
      ->type_name(kTable);
  soils->add_option("--seeds", *seeds, "Beds for each test")->check(CLI::Range(1, 100))->capture_default_str();
  soils->add_flag("--quick", request->tests.quick, "Smaller beds and shorter paths, for a first look");
  soils->add_option("--out", request->folder, "Folder for a figure and a table of each")->type_name(kFolder);
  add_wheel_options(*soils, request->wheel);
  add_examples(*soils,
               {"gonogo validate soils shear triaxial --out docs/validation --json",
                "gonogo validate soils mgru3_rover --calibration calibration_32mm --grain 0.016 --depth 0.15 \\\n"
                "      --seeds 1 --gpu"});
  soils->callback([&globals, request, calibration, wheel, seeds] {
    const auto table = [](const std::string& name) { return shipped_file("soils", "calibration", name); };
    request->tests.calibration = table(*calibration);
    request->wheel.calibration = wheel->empty() ? request->tests.calibration : table(*wheel);
    request->tests.seeds = request->wheel.seeds = *seeds;
    validate_soils(globals, *request);
  });
}

}  // namespace gonogo::app
