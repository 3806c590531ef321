// Stages of a run. A stage is done again only when something it depends on has changed.
//
// The stamp of a stage, <folder>/stamps/<name>.json, holds the hash of everything the stage read and of everything it
// wrote. It is written last, so an interrupted stage has none and is done again.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::app {

struct Stage {
  std::string name;                  // "train"
  std::vector<std::string> outputs;  // files or folders below the run's folder that the stage makes
  Json inputs;                       // object: what the outputs depend on, name -> hash or value
  std::function<void()> work;        // makes the outputs
};

/// Does the stage unless its stamp says that the outputs on disk were made from these inputs. Returns whether it did,
/// and logs what it does and why. Throws what `work` throws, and DeviceError when an output was not made.
bool run_stage(const std::filesystem::path& folder, const Stage& stage);

/// Hash of a file, or of the names and contents of the files in a folder. Throws InputError when it does not exist.
std::string path_hash(const std::filesystem::path& path);

}  // namespace gonogo::app
