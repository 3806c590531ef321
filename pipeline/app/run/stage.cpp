#include "pipeline/app/run/stage.h"

#include <algorithm>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"

namespace gonogo::app {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSchema = "gonogo/stamp/1";

fs::path stamp_file(const fs::path& folder, const Stage& stage) { return folder / "stamps" / (stage.name + ".json"); }

/// The last stamp, or null when there is none that can be used.
Json read_stamp(const fs::path& file) {
  if (!fs::exists(file)) return nullptr;
  try {
    Json stamp = Json::read(file);
    if (stamp.at("schema").string() != kSchema) return nullptr;
    stamp.at("inputs").members();
    stamp.at("outputs").members();
    return stamp;
  } catch (const InputError&) {
    log_line("run", file.string() + " cannot be used; its stage is done again");
    return nullptr;
  }
}

/// Names of the members of two objects that differ or that only one of them has.
std::vector<std::string> differences(const Json& before, const Json& now) {
  std::vector<std::string> names;
  for (const auto& [name, value] : now.members()) {
    const Json* old = before.find(name);
    if (!old || old->dump() != value.dump()) names.push_back(name);
  }
  for (const auto& [name, value] : before.members())
    if (!now.find(name)) names.push_back(name);
  return names;
}

/// Outputs that are gone or no longer what the stage wrote.
std::vector<std::string> damaged(const fs::path& folder, const Stage& stage, const Json& recorded) {
  std::vector<std::string> names;
  for (const auto& name : stage.outputs) {
    const Json* hash = recorded.find(name);
    if (!hash || !fs::exists(folder / name) || hash->dump() != Json(path_hash(folder / name)).dump())
      names.push_back(name);
  }
  return names;
}

/// Why the stage has to be done; empty when everything is as it was.
std::string reason_to_work(const fs::path& folder, const Stage& stage, const Json& stamp) {
  if (stamp.is_null()) return "not done yet";
  if (const auto changed = differences(stamp.at("inputs"), stage.inputs); !changed.empty())
    return "again, because these changed: " + join_words(changed);
  if (const auto lost = damaged(folder, stage, stamp.at("outputs")); !lost.empty())
    return "again, because these are missing or were altered: " + join_words(lost);
  return "";
}

void write_stamp(const fs::path& folder, const Stage& stage) {
  Json outputs = Json::object();
  for (const auto& name : stage.outputs) {
    if (!fs::exists(folder / name))
      throw DeviceError(stage.name + ": finished without making " + (folder / name).string());
    outputs[name] = path_hash(folder / name);
  }
  Json stamp = Json::object();
  stamp["schema"] = kSchema;
  stamp["inputs"] = stage.inputs;
  stamp["outputs"] = outputs;
  write_file_atomically(stamp_file(folder, stage), stamp.dump(2) + "\n");
}

}  // namespace

std::string path_hash(const fs::path& path) {
  if (!fs::is_directory(path)) return file_hash(path);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::string listing;
  for (const auto& file : files) listing += file.lexically_relative(path).string() + '\n' + file_hash(file) + '\n';
  return content_hash(listing);
}

bool run_stage(const fs::path& folder, const Stage& stage) {
  stop_if_cancelled();
  const fs::path file = stamp_file(folder, stage);
  const Json stamp = read_stamp(file);
  const std::string reason = reason_to_work(folder, stage, stamp);
  if (reason.empty()) {
    log_line(stage.name, "up to date");
    return false;
  }
  log_line(stage.name, reason);
  std::error_code ec;
  if (fs::remove(file, ec); ec) throw DeviceError(file.string() + ": cannot be removed: " + ec.message());
  stage.work();
  write_stamp(folder, stage);
  return true;
}

}  // namespace gonogo::app
