#include <cstdio>

#include "base/version.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/run/machine.h"

namespace gonogo::app {
namespace {

std::string gib(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GiB", double(bytes) / (1u << 30));
  return text;
}

std::string as_text(const Machine& machine) {
  std::string text = std::string("gonogo ") + program_version() + ", revision " + program_revision() + "\n";
  text += "processor  " + machine.processor + ", " + std::to_string(machine.cores) + " cores\n";
  text += "memory     " + gib(machine.memory_bytes) + ", " + gib(machine.available_bytes) + " available\n";
  text += "output     " + machine.out_folder.string() +
          (machine.out_writable ? " is writable, " : " is NOT writable, ") + gib(machine.disk_free_bytes) + " free\n";
  for (const auto& part : build_parts())
    text += part.name + std::string(part.name.size() < 11 ? 11 - part.name.size() : 1, ' ') +
            (part.version.empty() ? "left out of this build" : part.version) + "\n";
  return text;
}

Json as_json(const Machine& machine) {
  Json build = Json::object();
  for (const auto& part : build_parts()) build[part.name] = part.version.empty() ? Json(nullptr) : Json(part.version);
  Json result = Json::object();
  result["version"] = program_version();
  result["revision"] = program_revision();
  result["processor"] = machine.processor;
  result["cores"] = machine.cores;
  result["memory_bytes"] = machine.memory_bytes;
  result["memory_available_bytes"] = machine.available_bytes;
  result["out_folder"] = machine.out_folder.string();
  result["out_writable"] = machine.out_writable;
  result["disk_free_bytes"] = machine.disk_free_bytes;
  result["build"] = build;
  return result;
}

}  // namespace

void add_doctor_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("doctor", "What this machine and this build can do");
  auto out = std::make_shared<std::string>("out");
  command->add_option("--out", *out, "Folder for results: is it writable, how much is free")
      ->type_name(kFolder)
      ->capture_default_str();
  add_examples(*command, {"gonogo doctor --out /data/out"});
  command->callback([out, &globals] {
    const Machine machine = inspect_machine(*out);
    if (!machine.out_writable)
      fail_with_result(globals, as_json(machine), as_text(machine), InputError(machine.out_problem));
    print_result(globals, as_json(machine), as_text(machine));
  });
}

}  // namespace gonogo::app
