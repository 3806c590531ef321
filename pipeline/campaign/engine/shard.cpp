#include "pipeline/campaign/engine/shard.h"

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json/json.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFormat = "gonogo/shard/1";

fs::path manifest_path(const fs::path& folder, std::uint64_t shard) {
  return shard_folder(folder) / ("shard-" + std::to_string(shard) + ".json");
}

Json counts_json(const Counts& counts) {
  Json object = Json::object();
  for (const auto& [name, number] : counts) object[name] = std::uint64_t(number);
  return object;
}

Counts counts_in(const Json& object) {
  Counts counts;
  for (const auto& [name, number] : object.members()) counts[name] = std::size_t(number.unsigned_integer());
  return counts;
}

/// Removes files of the shard that its manifest does not name.
void remove_others(const fs::path& folder, std::uint64_t shard, const std::string& file) {
  const std::string start = "shard-" + std::to_string(shard) + ".";
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(start, 0) == 0 && entry.path().extension() == ".h5" && name != file)
      fs::remove(entry.path(), ignored);
  }
}

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError(path.string() + ": " + what);
}

void check_file(const fs::path& file, const ShardManifest& manifest) {
  std::error_code missing;
  const std::uint64_t bytes = fs::file_size(file, missing);
  if (missing) refuse(file, "is missing or cannot be read, though its manifest names it");
  if (bytes != manifest.bytes)
    refuse(file, "has " + std::to_string(bytes) + " bytes, its manifest says " + std::to_string(manifest.bytes));
  if (file_hash(file) != manifest.hash) refuse(file, "its bytes do not match the hash in its manifest");
}

}  // namespace

void count_outcome(const TrialRecord& record, Counts& by_verdict, Counts& by_reason) {
  ++by_verdict[contract().info(record.verdict).name];
  ++by_reason[contract().info(record.reason).name];
}

fs::path shard_folder(const fs::path& folder) { return folder / "shards"; }

void commit_shard(const fs::path& folder, std::uint64_t shard, const std::vector<TrialRecord>& records,
                  const Provenance& provenance, const std::string& campaign) {
  const std::string image = dataset_image({.records = records, .provenance = provenance});
  const std::string file = "shard-" + std::to_string(shard) + "." + std::to_string(records.size()) + ".h5";
  write_file_atomically(shard_folder(folder) / file, image);
  Counts by_verdict, by_reason;
  for (const TrialRecord& record : records) count_outcome(record, by_verdict, by_reason);
  Json manifest = Json::object();
  manifest["format"] = kFormat;
  manifest["campaign"] = campaign;
  manifest["first"] = records.front().point.index;
  manifest["trials"] = std::uint64_t(records.size());
  manifest["file"] = file;
  manifest["bytes"] = std::uint64_t(image.size());
  manifest["hash"] = content_hash(image);
  manifest["verdicts"] = counts_json(by_verdict);
  manifest["reasons"] = counts_json(by_reason);
  write_file_atomically(manifest_path(folder, shard), manifest.dump(2) + "\n");
  remove_others(folder, shard, file);
}

std::optional<ShardManifest> read_manifest(const fs::path& folder, std::uint64_t shard) {
  const fs::path path = manifest_path(folder, shard);
  std::error_code ec;
  if (!fs::exists(path, ec)) return std::nullopt;
  const Json json = Json::read(path);
  for (const char* key : {"format", "campaign", "first", "trials", "file", "bytes", "hash", "verdicts", "reasons"})
    if (!json.find(key)) refuse(path, std::string("lacks \"") + key + "\"");
  if (json.at("format").string() != kFormat) refuse(path, std::string("is not of the format ") + kFormat);
  return ShardManifest{.range = {json.at("first").unsigned_integer(), json.at("trials").unsigned_integer()},
                       .campaign = json.at("campaign").string(),
                       .file = json.at("file").string(),
                       .hash = json.at("hash").string(),
                       .bytes = json.at("bytes").unsigned_integer(),
                       .by_verdict = counts_in(json.at("verdicts")),
                       .by_reason = counts_in(json.at("reasons"))};
}

std::optional<std::vector<TrialRecord>> read_shard(const fs::path& folder, std::uint64_t shard,
                                                   const std::string& campaign) {
  const std::optional<ShardManifest> manifest = read_manifest(folder, shard);
  if (!manifest) return std::nullopt;
  const fs::path file = shard_folder(folder) / manifest->file;
  if (manifest->campaign != campaign) refuse(file, "its trials depend on other inputs than this campaign's");
  check_file(file, *manifest);
  Dataset dataset = read_dataset(file);
  if (dataset.records.size() != manifest->range.count)
    refuse(file, "holds " + std::to_string(dataset.records.size()) + " trials, its manifest says " +
                     std::to_string(manifest->range.count));
  for (std::size_t i = 0; i < dataset.records.size(); ++i)
    if (dataset.records[i].point.index != manifest->range.first + i)
      refuse(file, "its trials are not those that its manifest names");
  return std::move(dataset.records);
}

void set_shard_aside(const fs::path& folder, std::uint64_t shard) {
  const std::string start = "shard-" + std::to_string(shard) + ".";
  std::error_code ignored;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ignored)) {
    const std::string extension = entry.path().extension().string();
    if (entry.path().filename().string().rfind(start, 0) == 0 && (extension == ".h5" || extension == ".json"))
      files.push_back(entry.path());
  }
  for (const fs::path& file : files) fs::rename(file, file.string() + ".damaged", ignored);
}

}  // namespace gonogo::campaign
