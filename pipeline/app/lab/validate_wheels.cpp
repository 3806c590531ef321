#include <map>
#include <memory>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/parallel/for_each.h"
#include "base/progress.h"
#include "pipeline/app/lab/lab.h"
#include "pipeline/app/trials/numerics_options.h"
#include "pipeline/lab/wheels/analytic.h"
#include "pipeline/lab/wheels/report.h"

namespace gonogo::app {
namespace {

struct WheelsRequest {
  std::vector<std::string> benchmarks;
  std::string calibration = "calibration_32mm", folder;
  std::string trials;                // wheels.json of an earlier run
  std::vector<std::string> numbers;  // files of gonogo soil export
  bool nominal = false, formulas = false, no_soil_tests = false;
  double wheel_friction = -1;
  lab::WheelRun run;
};

/// Numbers of soils by key_of, and why other soils have none.
struct Numbers {
  std::map<std::string, inspect::SoilNumbers> of;
  std::map<std::string, std::string> why_not;
};

std::string key_of(const std::string& soil, const std::string& state) { return soil + ", " + state; }

inspect::SoilNumbers tested_numbers(const lab::Benchmark& b, const lab::WheelRun& run) {
  inspect::SoilNumbersRequest tests;
  tests.soil = b.soil_path;
  tests.state = b.soil.name;
  tests.calibration = run.calibration;
  tests.grain = run.grain;
  tests.seeds = run.seeds;
  tests.threads = run.threads;
  return inspect::measure_soil_numbers(tests);
}

/// Numbers that files give, and those of all other soils by tests, unless the run is quick or without tests or trials.
/// Tests that fit no numbers leave the formulas without them.
Numbers soil_numbers(const WheelsRequest& request, const std::vector<lab::Benchmark>& benchmarks) {
  Numbers numbers;
  for (const std::string& file : request.numbers) {
    const inspect::SoilNumbers n = inspect::read_soil_numbers(file);
    numbers.of.emplace(key_of(n.soil, n.state), n);
  }
  if (request.run.quick || request.formulas || request.no_soil_tests) return numbers;
  for (const lab::Benchmark& b : benchmarks) {
    const std::string key = key_of(b.soil_file, b.soil.name);
    if (numbers.of.count(key) || numbers.why_not.count(key)) continue;
    stop_if_cancelled();
    try {
      numbers.of.emplace(key, tested_numbers(b, request.run));
    } catch (const InputError& error) {
      numbers.why_not.emplace(key, error.what());
    }
  }
  return numbers;
}

/// The formulas that this benchmark's soil has numbers for; the others are named in `missing`.
std::vector<lab::Predictor> formulas_of(const lab::Benchmark& b, const Numbers& numbers,
                                        std::vector<std::string>& missing) {
  std::vector<lab::Predictor> formulas;
  if (const std::string remark = lab::strength_remark(b); !remark.empty()) missing.push_back(remark);
  if (const auto measured = lab::measured_numbers(b))
    formulas.push_back(lab::analytic_predictor(b, *measured, "Bekker-Wong, measured soil", b.soil_file));
  else
    missing.push_back("no Bekker-Wong with measured numbers: the soil file has no n, k_c, k_phi and K");
  const std::string key = key_of(b.soil_file, b.soil.name);
  if (const auto own = numbers.of.find(key); own != numbers.of.end()) {
    formulas.push_back(lab::analytic_predictor(b, lab::exported_numbers(own->second), "Bekker-Wong, our soil tests",
                                               own->second.table));
    return formulas;
  }
  const auto why = numbers.why_not.find(key);
  missing.push_back("no Bekker-Wong with numbers of our tests: " +
                    (why != numbers.why_not.end() ? why->second : "give --soil-numbers, or let the tests run"));
  return formulas;
}

std::vector<lab::Benchmark> benchmarks_of(const WheelsRequest& request) {
  std::vector<lab::Benchmark> benchmarks;
  for (const std::string& name : request.benchmarks.empty() ? lab::benchmark_names() : request.benchmarks) {
    lab::Benchmark b = lab::read_benchmark(name);
    // A rover takes longer than all wheels together: a quick run of everything leaves it out.
    if (request.run.quick && request.benchmarks.empty() && lab::is_whole(b)) continue;
    lab::choose_state(b, request.run.state);
    if (request.run.quick) lab::keep_quick_points(b);
    benchmarks.push_back(std::move(b));
  }
  return benchmarks;
}

std::vector<lab::WheelReport> in_order(const std::map<std::size_t, lab::WheelReport>& reports) {
  std::vector<lab::WheelReport> all;
  for (const auto& [i, r] : reports) all.push_back(r);
  return all;
}

void print_reports(const Globals& globals, const std::vector<lab::WheelReport>& reports) {
  Json json = Json::object();
  std::string text;
  int failed = 0;
  for (const lab::WheelReport& r : reports) {
    json[r.benchmark.name] = lab::as_json(r);
    text += lab::as_text(r);
    failed += lab::failures(r);
  }
  json["failed"] = failed;
  if (failed > 0)
    fail_with_result(globals, json, text, DeviceError(std::to_string(failed) + " bounds of wheels do not hold"));
  print_result(globals, json, text);
}

void validate_wheels(const Globals& globals, WheelsRequest& request) {
  request.run.calibration = shipped_file("soils", "calibration", request.calibration);
  request.run.threads = threads_or_all(globals.threads);
  request.run.band = !request.nominal;
  if (request.wheel_friction >= 0) request.run.wheel_friction = request.wheel_friction;
  const std::vector<lab::Benchmark> benchmarks = benchmarks_of(request);
  const bool runs = !request.formulas && request.trials.empty();
  std::vector<lab::WheelOutcome> outcomes(benchmarks.size());
  if (!request.trials.empty()) outcomes = lab::read_outcomes(request.trials, benchmarks);
  const Numbers numbers = soil_numbers(request, benchmarks);
  std::map<std::size_t, lab::WheelReport> reports;  // by benchmark
  const auto report = [&](std::size_t i, const lab::WheelOutcome& outcome) {
    std::vector<std::string> missing;
    const auto formulas = formulas_of(benchmarks[i], numbers, missing);
    const auto& added = reports.emplace(i, lab::report_of(benchmarks[i], outcome, formulas, missing)).first->second;
    if (request.folder.empty()) return;
    lab::write_report(request.folder, added);
    lab::write_overview(request.folder, in_order(reports));
  };
  if (runs) lab::run_wheels(benchmarks, request.run, report);
  for (std::size_t i = 0; !runs && i < benchmarks.size(); ++i) report(i, outcomes[i]);
  print_reports(globals, in_order(reports));
}

void add_bed_options(CLI::App& wheels, lab::WheelRun& run) {
  CLI::App& of = *wheels.add_option_group("bed", "Grains and bed; what is not given follows from the wheel's size");
  of.add_option(
        "--grain", run.grain,
        "Grain diameter [m]; default: a tenth of the wheel's width, an eighth under slip angles, or as large as "
        "lower lugs")
      ->check(CLI::Range(0.0005, 0.2));
  of.add_option("--depth", run.depth, "Depth of the bed [m]; default: 0.8 radii")->check(CLI::Range(0.01, 2.0));
  of.add_option("--length", run.length, "Length of the bed [m]; default: 8 radii")->check(CLI::Range(0.1, 20.0));
  of.add_option("--width", run.width, "Width of the bed [m]; default: 3.5 widths of the wheel")
      ->check(CLI::Range(0.05, 10.0));
  of.add_option("--time", run.time, "Time driven [s], of which the last half counts; default: by way")
      ->check(CLI::Range(0.1, 1000.0));
  add_asked_numerics_options(of, run.numerics, "Trials");
}

}  // namespace

void add_wheels_check(CLI::App& validate, const Globals& globals) {
  CLI::App* wheels = validate.add_subcommand(
      "wheels", "Wheels measured by others: trials and formulas beside them; fails when a bound is not kept");
  auto r = std::make_shared<WheelsRequest>();
  add_named(*wheels, "benchmarks", r->benchmarks, kBenchmark, "Benchmarks; default: all that ship");
  add_named(*wheels, "--calibration", r->calibration, kTable, "Table of the grains")->capture_default_str();
  add_number(*wheels, "--seeds", r->run.seeds, {1, 100}, "Beds per point");
  wheels->add_flag("--quick", r->run.quick,
                   "Three points, one bed, coarse grains, small beds, no band, no soil tests: minutes on two cores");
  wheels->add_flag("--nominal", r->nominal, "No trials at the ends of what is assumed");
  CLI::Option* formulas = wheels->add_flag("--formulas", r->formulas, "Only the formulas, without trials");
  add_named(*wheels, "--trials", r->trials, kFile,
            "wheels.json of an earlier run in the place of trials: tables, figures and formulas are made anew")
      ->excludes(formulas);
  add_named(*wheels, "--soil-numbers", r->numbers, kFile,
            "Numbers by gonogo soil export --format bekker; default: tests are run");
  wheels->add_flag("--no-soil-tests", r->no_soil_tests,
                   "No plate and shear tests: formulas have only numbers that were measured or given");
  wheels->add_option("--state", r->run.state, "State of the soil; default: the benchmark's");
  wheels->add_option("--wheel-friction", r->wheel_friction, "Of grains on the wheels [-]; default: the benchmark's")
      ->check(CLI::Range(0.0, 2.0));
  add_wheel_rolling_option(*wheels, r->run.wheel_rolling);
  wheels->add_flag("--gpu", r->run.gpu, "Run on the GPU, all trials of one grain size side by side");
  add_named(*wheels, "--out", r->folder, kFolder, "Folder for tables, figures and JSON");
  add_bed_options(*wheels, r->run);
  add_examples(*wheels,
               {"gonogo validate wheels --quick",
                "gonogo validate wheels ding_lugs my_wheel.json --grain 0.016 --gpu --out out/wheels",
                "gonogo validate wheels --formulas  # seconds",
                "gonogo validate wheels --trials out/wheels/wheels.json --soil-numbers ding2011.json --out out/again"});
  wheels->callback([&globals, r, wheels] {
    if (r->run.quick && wheels->get_option("--seeds")->count() == 0) r->run.seeds = 1;
    validate_wheels(globals, *r);
  });
}

}  // namespace gonogo::app
