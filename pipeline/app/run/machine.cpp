#include "pipeline/app/run/machine.h"

#include <unistd.h>

#include <fstream>

#include "base/cores.h"
#include "base/error.h"
#include "base/file.h"

namespace gonogo::app {
namespace fs = std::filesystem;
namespace {

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

}  // namespace

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

std::vector<BuildPart> build_parts() {
  return {{"build type", GONOGO_BUILD_TYPE}, {"compiler", GONOGO_COMPILER},      {"HDF5", GONOGO_HDF5_VERSION},
          {"CUDA", GONOGO_CUDA_VERSION},     {"LibTorch", GONOGO_TORCH_VERSION}, {"GDAL", GONOGO_GDAL_VERSION}};
}

}  // namespace gonogo::app
