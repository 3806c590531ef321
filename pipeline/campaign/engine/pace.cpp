#include "pipeline/campaign/engine/pace.h"

#include <fstream>

#include "base/error.h"
#include "base/json/json.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::seconds kInterval(2);

fs::path pace_folder(const fs::path& folder) { return folder / "progress"; }

}  // namespace

PaceWriter::PaceWriter(const fs::path& folder, const std::string& writer)
    : path_(pace_folder(folder) / (writer + ".json")), start_(std::chrono::steady_clock::now()), last_(start_) {}

PaceWriter::~PaceWriter() {
  std::error_code ignored;
  fs::remove(path_, ignored);
  fs::remove(path_.parent_path(), ignored);  // when it is empty
}

void PaceWriter::tell_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kInterval) return;
  last_ = now;
  std::error_code ignored;
  fs::create_directories(path_.parent_path(), ignored);
  const fs::path beside = path_.string() + ".new";
  Json json = Json::object();
  json["trials"] = std::uint64_t(done_);
  json["seconds"] = std::chrono::duration<double>(now - start_).count();
  // Not flushed to the disk: it is worth nothing after a crash.
  std::ofstream(beside) << json.dump() << "\n";
  fs::rename(beside, path_, ignored);
}

double total_pace(const fs::path& folder) {
  double pace = 0;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(pace_folder(folder), none)) {
    if (entry.path().extension() != ".json") continue;
    try {
      const Json json = Json::read(entry.path());
      if (json.at("seconds").number() > 0) pace += json.at("trials").number() / json.at("seconds").number();
    } catch (const InputError&) {  // it ended while we looked
    }
  }
  return pace;
}

void forget_paces(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(pace_folder(folder), ignored);
}

}  // namespace gonogo::campaign
