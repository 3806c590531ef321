// gonogo doctor: facts of the machine and the build.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "base/version.h"
#include "pipeline/app/cli/command.h"

namespace gonogo::app {
namespace fs = std::filesystem;
namespace {

/// A library or option that is part of this build or left out of it.
struct BuildPart {
  std::string name;
  std::string version;  // empty: left out
};

struct Machine {
  std::string processor;              // model name as the kernel reports it
  int cores = 0;                      // that this process may use
  std::uint64_t memory_bytes = 0;     // installed
  std::uint64_t available_bytes = 0;  // without swapping
  fs::path out_folder;
  bool out_writable = false;
  std::string out_problem;            // one sentence; empty when writable
  std::uint64_t disk_free_bytes = 0;  // for the output folder, as this user
};

/// Text after "key :" on the first line of a /proc file that starts with `key`; empty when there is none.
std::string proc_value(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const auto colon = line.find(':');
    const auto start = line.find_first_not_of(" \t", colon == std::string::npos ? colon : colon + 1);
    return start == std::string::npos ? "" : line.substr(start);
  }
  return "";
}

std::uint64_t proc_memory_bytes(const std::string& key) {
  const std::string kibibytes = proc_value("/proc/meminfo", key);
  return kibibytes.empty() ? 0 : std::stoull(kibibytes) * 1024;
}

/// The folder itself, or the closest parent that exists.
fs::path existing_part(fs::path folder) {
  folder = fs::absolute(folder);
  std::error_code ec;
  while (!fs::exists(folder, ec) && folder.has_parent_path() && folder != folder.parent_path())
    folder = folder.parent_path();
  return folder;
}

/// Proves that a file can be written there by writing one; empty when it can.
std::string writing_problem(const fs::path& folder) {
  if (!fs::is_directory(folder)) return folder.string() + ": a file stands there, a folder is needed";
  const fs::path probe = folder / (".gonogo-probe-" + std::to_string(::getpid()));
  try {
    write_file_atomically(probe, "probe");
    fs::remove(probe);
    return "";
  } catch (const std::exception& error) {
    return folder.string() + ": cannot write there; choose another folder or fix its permissions";
  }
}

/// Looks at the machine; `out_folder` need not exist, nothing is left behind in it or beside it.
Machine inspect_machine(const fs::path& out_folder) {
  Machine machine;
  machine.processor = proc_value("/proc/cpuinfo", "model name");
  machine.cores = threads_or_all(0);
  machine.memory_bytes = proc_memory_bytes("MemTotal");
  machine.available_bytes = proc_memory_bytes("MemAvailable");
  machine.out_folder = out_folder;
  const fs::path existing = existing_part(out_folder);
  machine.out_problem = writing_problem(existing);
  machine.out_writable = machine.out_problem.empty();
  std::error_code ec;
  const auto space = fs::space(existing, ec);
  machine.disk_free_bytes = ec ? 0 : space.available;
  return machine;
}

/// Build type, compiler and the optional libraries of this build.
std::vector<BuildPart> build_parts() {
  return {{"build type", GONOGO_BUILD_TYPE}, {"compiler", GONOGO_COMPILER},      {"HDF5", GONOGO_HDF5_VERSION},
          {"CUDA", GONOGO_CUDA_VERSION},     {"LibTorch", GONOGO_TORCH_VERSION}, {"GDAL", GONOGO_GDAL_VERSION}};
}

std::string gib(std::uint64_t bytes) { return line("%.1f GiB", double(bytes) / (1u << 30)); }

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
  add_named(*command, "--out", *out, kFolder, "Folder for results: is it writable, how much is free")
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
