// Facts of the machine and the build, as `gonogo doctor` reports them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::app {

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
  std::filesystem::path out_folder;
  bool out_writable = false;
  std::string out_problem;            // one sentence; empty when writable
  std::uint64_t disk_free_bytes = 0;  // for the output folder, as this user
};

/// Looks at the machine; `out_folder` need not exist, nothing is left behind in it or beside it.
Machine inspect_machine(const std::filesystem::path& out_folder);

/// Build type, compiler and the optional libraries of this build.
std::vector<BuildPart> build_parts();

}  // namespace gonogo::app
