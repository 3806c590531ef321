#include <algorithm>
#include <memory>
#include <string>

#include "base/files/file.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/inspect/vehicle_report.h"
#include "pipeline/lab/original.h"

namespace gonogo::app {
namespace {

struct OriginalOptions {
  std::string input, vehicle = "hmmwv", folder;
  int line = 1;
  bool gpu = false;
  lab::OriginalRequest request;
};

void original(const Globals& globals, OriginalOptions options) {
  lab::OriginalRequest& r = options.request;
  r.input = lab::read_original_input(options.input, options.line);
  r.backend = options.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  r.threads = threads_or_all(globals.threads);
  const vehicle::Vehicle v = vehicle::read_vehicle(inspect::vehicle_file(options.vehicle));
  sim::require_backend(r.backend);
  const lab::OriginalRecord record = lab::run_original(v, r);
  const lab::OriginalSample& last = record.sample.back();
  Json json;
  json["stop"] = lab::stop_sentence(record.stop);
  json["grains"] = record.grains;
  json["surface_m"] = record.surface;
  json["slowed"] = std::int64_t(record.slowed);
  json["time_s"] = last.time;
  json["x_m"] = last.position.x;
  json["y_m"] = last.position.y;
  const std::string text =
      line("%s\n%zu grains, highest at %.0f mm, slowed %lld times; %.2f s, x %.3f m, y %.3f m, %.2f m/s\n",
           lab::stop_sentence(record.stop), record.grains, 1e3 * record.surface, static_cast<long long>(record.slowed),
           last.time, last.position.x, last.position.y, last.velocity.x);
  if (!options.folder.empty()) {
    create_folder(options.folder);
    const auto file = std::filesystem::path(options.folder) / ("results_" + std::to_string(options.line) + ".out");
    write_file_atomically(file, lab::original_output(record));
    json["file"] = file.string();
  }
  if (record.stop == lab::OriginalStop::failed)
    fail_with_result(globals, json, text, DeviceError("the run failed: " + record.fault));
  print_result(globals, json, text);
}

}  // namespace

void add_original_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("original", "One run of the original study's fixed bin, from a line of its input file");
  auto o = std::make_shared<OriginalOptions>();
  add_named(*command, "input", o->input, kFile,
            "Text file, a run per line: slope [deg], radius [mm], density, friction, kPa")
      ->required();
  command->add_option("--line", o->line, "Line of the run, from 1")->capture_default_str();
  add_named(*command, "--vehicle", o->vehicle, kVehicle, "Vehicle")->capture_default_str();
  add_named(*command, "--out", o->folder, kFolder, "Folder for results_<line>.out");
  add_number(*command, "--tyre-friction", o->request.tyre_friction, {0.0, 3.0},
             "Friction of the tyres [-]; the larger of theirs and the soil's acts");
  command->add_option("--seed", o->request.seed, "Seed of the grains' places")->check(kSeed)->capture_default_str();
  add_number(*command, "--end", o->request.time.end, {0.5, 100.0}, "Time limit of the run [s]");
  command->add_flag("--gpu", o->gpu, "Run on the GPU");
  add_examples(*command, {"gonogo original inputs.txt --line 3 --out results --gpu"});
  command->callback([&globals, o] { original(globals, *o); });
}

}  // namespace gonogo::app
