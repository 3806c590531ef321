#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "base/progress.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/trials/numerics_options.h"
#include "pipeline/campaign/setup/read_setup.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/inspect/trial_film.h"
#include "pipeline/inspect/vehicle_report.h"
#include "sim/simulation/parts/divided.h"

namespace gonogo::app {
namespace {

struct SimulateOptions {
  std::string study, vehicle, soil, task, csv;
  std::optional<double> slope_along, slope_across;  // [deg]
  std::optional<double> gravity;                    // [m/s^2]
  std::vector<std::string> settings;
  std::uint64_t seed = 0;
  report::FilmRequest film;
  campaign::TrialCheckpoint checkpoint;
  terrain::AskedNumerics numerics;
  std::string size = "1280x720", colour = "speed";
  double azimuth = inspect::FilmedTrial().azimuth, elevation = inspect::FilmedTrial().elevation;  // [deg]
  bool gpu = false, compliant = false, folded = false, numerics_given = false, wheel_rolling_given = false;
  double wheel_rolling = 1;
  int gpus = 0;  // not given
};

sim::Backend device_of(const SimulateOptions& options) {
  return options.gpu || options.gpus > 0 ? sim::Backend::cuda : sim::Backend::cpu;
}

/// Values from --slope, --cross-slope and --set in the place of the others.
std::vector<double> with_settings(std::vector<double> values, const SimulateOptions& options) {
  const auto set_slope = [&](const char* name, const char* option, std::optional<double> slope) {
    if (slope) campaign::set_value(values, name, *slope, option + line(" %g", *slope));
  };
  set_slope("slope_along", "--slope", options.slope_along);
  set_slope("slope_across", "--cross-slope", options.slope_across);
  for (const std::string& setting : options.settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) throw InputError("--set " + setting + ": write it as name=value");
    const std::string text = setting.substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool is_number = !text.empty() && *end == 0;
    campaign::set_value(values, setting.substr(0, equals), is_number ? value : std::nan(""), "--set " + setting);
  }
  return values;
}

report::FilmRequest film_request(const Globals& globals, const SimulateOptions& options) {
  report::FilmRequest film = options.film;
  int used = 0;
  if (std::sscanf(options.size.c_str(), "%dx%d%n", &film.width, &film.height, &used) != 2 ||
      used != int(options.size.size()))
    throw InputError("--size " + options.size + ": write it as WIDTHxHEIGHT in pixels, such as 1280x720");
  film.colour = options.colour == "height" ? report::GrainColour::height : report::GrainColour::speed;
  film.threads = threads_or_all(globals.threads);
  report::check_film(film);
  return film;
}

/// As campaign::run_trial(); after Ctrl-C tells how a trial is kept.
campaign::TrialRecord run_or_say_lost(const campaign::TrialSetup& setup, const campaign::DesignPoint& point,
                                      const campaign::TrialWatch& watch, const campaign::TrialCheckpoint& checkpoint,
                                      const campaign::TrialDevice& device) {
  try {
    return campaign::run_trial(setup, point, watch, checkpoint, device);
  } catch (const Cancelled&) {
    if (!checkpoint.path.empty()) throw;
    throw Cancelled("interrupted; the trial will begin anew: --checkpoint FILE saves it while it runs");
  }
}

/// Runs the trial and writes its CSV file, pictures, video and VTK files.
campaign::TrialRecord watched_trial(const Globals& globals, const SimulateOptions& options,
                                    const campaign::TrialSetup& setup, const campaign::DesignPoint& point) {
  if (!options.checkpoint.path.empty() && options.film.wants_series())
    throw InputError(
        "--checkpoint does not go with --frames, --vtk or --video: a continued run has no pictures of its "
        "beginning; leave one out");
  const auto value = [&](const char* name) { return point.variables[campaign::contract().variable_index(name)]; };
  inspect::TrialFilm film(film_request(globals, options), {.title = setup.name,
                                                           .slope_along = value("slope_along"),
                                                           .slope_across = value("slope_across"),
                                                           .commanded_speed = value("commanded_speed"),
                                                           .azimuth = options.azimuth,
                                                           .elevation = options.elevation});
  sim::require_backend(device_of(options));
  campaign::prepare_trials(setup, {&point, 1}, threads_or_all(globals.threads));
  std::string csv;
  const double time = setup.park_time + setup.time_limit;
  const auto steps = std::size_t(std::lround(time / setup.numerics.step));
  std::size_t taken = 0;
  Progress progress("trial", "steps", steps);
  progress.announce(line("lets the vehicle down and drives for at most %.3g s", time));
  campaign::TrialWatch watch;
  watch.start = [&] {
    taken = 0;
    csv = campaign::kSampleColumns;
    film.start();
  };
  std::vector<sim::PartShare> shares;  // of the GPUs
  watch.shares = [&](const std::vector<sim::PartShare>& now) { shares = now; };
  watch.sample = [&](const campaign::TrialSample& s) {
    csv += campaign::csv_line(s);
    const std::string loads = shares.empty() ? "" : ", " + sim::loads_text(shares);
    progress.update(std::min(++taken, steps), line("%.2f m after %.1f s", s.x, s.time) + loads);
  };
  if (options.film.wants_pictures() || options.film.wants_series())
    watch.frame = [&film](const campaign::TrialFrame& frame) { film.add(frame); };
  watch.frame_interval = options.film.wants_series() ? options.film.every : setup.time_limit;
  const int gpus = campaign::gpus_left(options.gpus, int(sim::cuda_device_names().size()), options.checkpoint);
  const campaign::TrialDevice device{device_of(options), threads_or_all(globals.threads), gpus};
  campaign::TrialRecord record = run_or_say_lost(setup, point, watch, options.checkpoint, device);
  progress.finish();
  if (!shares.empty()) log_line("trial", sim::shares_text(shares));
  if (!options.csv.empty()) write_file_atomically(options.csv, csv);
  film.finish(record);
  return record;
}

struct Request {
  campaign::TrialSetup setup;
  campaign::DesignPoint point;
};

/// Throws InputError unless either a study, or a vehicle and a soil are given.
Request request_of(const SimulateOptions& options) {
  if (options.study.empty() == options.vehicle.empty())
    throw InputError("name a study, or --vehicle and --soil; one of the two");
  Request r;
  r.point.seed = options.seed;
  if (options.vehicle.empty()) {
    if (options.compliant)
      throw InputError("--compliant-tyres goes with --vehicle; in a study it is trial.compliant_tyres");
    if (options.wheel_rolling_given)
      throw InputError("--wheel-rolling goes with --vehicle; in a study it is trial.wheel_rolling");
    if (options.folded) throw InputError("--folded goes with --vehicle; in a study it is trial.bed.folded");
    if (options.numerics_given)
      throw InputError(
          "--step, --substeps, --iterations, --tolerance and --target go with --vehicle; in a study they are "
          "trial.numerics");
    if (options.gravity) throw InputError("--gravity goes with --vehicle; in a study it is gravity");
    if (!options.task.empty()) throw InputError("--trial goes with --vehicle; in a study it is trial.task");
    const campaign::Study study = campaign::read_study(options.study);
    r.setup = campaign::read_trial_setup(study, campaign::default_packing_folder(), device_of(options));
    r.point.variables = with_settings(campaign::middle_values(study), options);
    campaign::check_all_given(r.point.variables, options.study);
    return r;
  }
  if (options.soil.empty()) throw InputError("--vehicle needs --soil: a calibration, such as calibration_90mm");
  r.setup = campaign::vehicle_trial_setup(
      inspect::vehicle_file(options.vehicle), shipped_file("soils", "calibration", options.soil),
      options.task.empty() ? campaign::default_task() : campaign::parse_task(options.task), options.numerics);
  if (options.folded) campaign::fold_bed(r.setup);
  r.setup.settled_on = device_of(options);
  r.setup.compliant_tyres = options.compliant;
  r.setup.wheel_rolling = options.wheel_rolling;
  r.setup.gravity = options.gravity.value_or(kGravity);
  campaign::check_tyres(r.setup);
  r.point.variables = with_settings(campaign::usual_values(r.setup), options);
  return r;
}

/// Wheels of a whole vehicle, and whether the label obeys the scale rule.
void add_vehicle(const campaign::TrialSetup& setup, const campaign::TrialRecord& record, Json& json,
                 std::string& text) {
  const double grains = campaign::grains_per_tyre(setup);
  json["grains_per_tyre"] = grains;
  json["label"] = grains >= campaign::kGrainsPerTyre ? "fine" : "coarse";
  if (grains < campaign::kGrainsPerTyre) {
    text += line("coarse label: a tyre or shoe is %.1f grains wide, %.0f are needed for one to publish\n", grains,
                 campaign::kGrainsPerTyre);
  }
  for (const campaign::WheelRecord& w : record.wheels) {
    Json wheel;
    wheel["name"] = w.name;
    wheel["slip"] = w.slip;
    wheel["sinkage_m"] = w.sinkage;
    wheel["torque_N_m"] = w.torque;
    json["wheels"].push_back(std::move(wheel));
    text += line("%-18s", w.name.c_str());
    if (std::isfinite(w.slip)) text += line(" slip %6.3f  torque %7.0f N m ", w.slip, w.torque);
    if (std::isfinite(w.sinkage)) text += line(" sinkage %6.1f mm", 1e3 * w.sinkage);
    text += "\n";
  }
}

/// The curve of a drawbar sweep.
void add_pull(const campaign::TrialRecord& record, Json& json, std::string& text) {
  if (record.pull.empty()) return;
  text += "pull/weight    slip  speed [m/s]  sinkage [mm]  torque [N m]\n";
  for (const campaign::PullPoint& p : record.pull) {
    Json point;
    point["pull_per_weight"] = p.pull;
    point["slip"] = p.slip;
    point["speed_m_per_s"] = p.speed;
    point["sinkage_m"] = p.sinkage;
    point["torque_N_m"] = p.torque;
    if (p.side != 0) point["side_per_weight"] = p.side;
    json["pull"].push_back(std::move(point));
    text += line("%11.3f  %6.3f  %11.3f  %12.1f  %12.0f\n", p.pull, p.slip, p.speed, 1e3 * p.sinkage, p.torque);
    if (p.side != 0) text += line("side force over weight %.3f, to the left of the heading\n", p.side);
  }
}

void simulate(const Globals& globals, const SimulateOptions& options) {
  const auto [setup, point] = request_of(options);
  const campaign::TrialRecord record = watched_trial(globals, options, setup, point);
  Json json;
  json["trial"] = setup.task->name();
  json["verdict"] = campaign::contract().info(record.verdict).name;
  json["reason"] = campaign::contract().info(record.reason).name;
  std::string text = "verdict  " + campaign::contract().info(record.verdict).name + " / " +
                     campaign::contract().info(record.reason).name + "\n";
  for (std::size_t v = 0; v < point.variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable) && point.variables[v] == 0) continue;
    json["variables"][variable.name] = point.variables[v];
    text += line("%-18s %10.4g %s\n", variable.name.c_str(), point.variables[v], variable.unit.c_str());
  }
  json[campaign::kGravityKey] = setup.gravity;
  text += line("%-18s %10.4g m/s2\n", "gravity", setup.gravity);
  for (std::size_t m = 0; m < record.measures.size(); ++m) {
    if (!campaign::has_measure(record, m)) continue;
    const campaign::Measure& measure = campaign::contract().measures[m];
    json["measures"][measure.name] = record.measures[m];
    text += line("%-18s %10.4g %s\n", measure.name.c_str(), record.measures[m], measure.unit.c_str());
  }
  terrain::write_numerics(json["numerics"], setup.numerics);
  text += "numerics  " + terrain::description(setup.numerics) + "\n";
  add_vehicle(setup, record, json, text);
  add_pull(record, json, text);
  print_result(globals, json, text);
}

}  // namespace

void add_simulate_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("simulate", "Run one trial and say how it ended");
  auto options = std::make_shared<SimulateOptions>();
  add_named(*command, "study", options->study, kStudy, "Study file (JSON); or give --vehicle and --soil");
  add_named(*command, "--vehicle", options->vehicle, kVehicle, "Vehicle, with --soil");
  add_named(*command, "--soil", options->soil, kTable, "Calibration of the grains, with --vehicle");
  add_named(*command, "--trial", options->task, "TRIAL",
            "Type of trial with its numbers, with --vehicle: " + campaign::task_examples());
  command->add_option("--slope", options->slope_along, "Slope along, uphill positive [deg]");
  command->add_option("--cross-slope", options->slope_across, "Slope across, left side higher positive [deg]");
  command->add_option("--gravity", options->gravity, "Gravity, with --vehicle; the Earth's by default [m/s2]")
      ->check(CLI::Range(campaign::kGravityRange.minimum, campaign::kGravityRange.maximum));
  add_named(*command, "--set", options->settings, kSetting,
            "Value of a variable; the others have the study's fixed value or mid-range");
  command->add_option("--seed", options->seed, "Seed of the bed")->check(kSeed);
  command->add_flag("--compliant-tyres", options->compliant, "Tyres of the stiffness in the vehicle's file");
  add_wheel_rolling_option(*command, options->wheel_rolling);
  command->add_flag("--folded", options->folded,
                    "Bed of two thirds of the track, periodic across, with a third of the grains");
  add_asked_numerics_options(*command, options->numerics, "With --vehicle");
  command->add_flag("--gpu", options->gpu, "Run on the GPU");
  command
      ->add_option(
          "--gpus", options->gpus,
          "Number of GPUs over which the world is divided, with the same bits; default: with --gpu, as many as pay")
      ->check(CLI::Range(1, 8));
  add_named(*command, "--csv", options->csv, kFile, "CSV file for the run step by step");
  add_named(*command, "--checkpoint", options->checkpoint.path, kFile,
            "File to which the running trial is saved; where it exists, the trial continues from it");
  command->add_option("--checkpoint-every", options->checkpoint.every, "Wall-clock time between two checkpoints [s]")
      ->check(CLI::Range(0.0, 1e6));
  add_named(*command, "--picture", options->film.picture, kFile, "PNG file for a picture of the trial's end");
  add_named(*command, "--frames", options->film.frames, kFolder, "Folder for a PNG per interval");
  add_named(*command, "--vtk", options->film.vtk, kFolder, "Folder for VTK files per interval, for ParaView");
  add_named(*command, "--video", options->film.video, kFile, "MP4 file for a video of the trial; needs ffmpeg");
  command->add_option("--every", options->film.every, "Interval of frames, VTK files and video [s]")
      ->check(CLI::Range(1e-4, 100.0));
  add_named(*command, "--size", options->size, "WIDTHxHEIGHT", "Size of pictures [pixels]");
  command->add_option("--colour", options->colour, "What colours the grains")
      ->check(CLI::IsMember({"speed", "height"}));
  command->add_option("--azimuth", options->azimuth, "Turns the camera from the right side towards the front [deg]")
      ->check(CLI::Range(-180.0, 180.0));
  command->add_option("--elevation", options->elevation, "Raises the camera; 50 shows ruts [deg]")
      ->check(CLI::Range(0.0, 89.0));
  add_examples(
      *command,
      {"gonogo simulate configs/studies/demo.json --set slope_along=12 --set friction_angle=30",
       "gonogo simulate --vehicle hmmwv --soil configs/soils/calibration_90mm.json --slope 12 --video out/climb.mp4",
       "gonogo simulate --vehicle hmmwv --soil configs/soils/calibration_90mm.json --trial drawbar",
       "gonogo simulate configs/studies/viper_32mm.json --gpus 2 --checkpoint out/trial.h5",
       "gonogo simulate configs/studies/demo.json --picture out/trial.png --vtk out/vtk --every 0.05"});
  command->callback([&globals, options, command] {
    options->numerics_given = numerics_given(*command);
    options->wheel_rolling_given = command->count("--wheel-rolling") > 0;
    simulate(globals, *options);
  });
}

}  // namespace gonogo::app
