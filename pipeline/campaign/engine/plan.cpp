#include "pipeline/campaign/engine/plan.h"

#include <gnu/libc-version.h>

#include "base/error.h"
#include "base/file.h"
#include "base/format.h"
#include "base/hash.h"
#include "base/version.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/folder.h"

namespace gonogo::campaign {
namespace {

constexpr const char* kSections[] = {"soil", "trial", "design"};

/// Leaves of a JSON value by path: {"trial.step_s": "0.001", ...}, so that a change can be named.
void add_leaves(const std::string& path, const Json& value, Dependencies& leaves) {
  if (!value.is_object()) {
    leaves.emplace_back(path, value.dump());
    return;
  }
  const std::string prefix = path + ".";
  for (const auto& [key, member] : value.members()) add_leaves(prefix + key, member, leaves);
}

/// The parts of the study that trials depend on.
Json relevant_study(const Study& study) {
  Json relevant = Json::object();
  relevant["study"] = study.name;
  relevant["seed"] = study.seed;
  if (study.gravity != kGravity) relevant["gravity"] = study.gravity;
  for (const char* section : kSections)
    if (const Json* value = study.config.json().find(section)) relevant[section] = *value;
  return relevant;
}

Dependencies dependencies(const Study& study, const Provenance& provenance) {
  Dependencies result{{"program", provenance.program_version},
                      {"backend", provenance.backend},
                      {"contract", provenance.contract_hash},
                      {"seed", std::to_string(study.seed)}};
  for (const auto& [name, version] : provenance.libraries) result.emplace_back(name, version);
  for (const auto& [name, hash] : provenance.inputs) result.emplace_back("content of " + name, hash);
  for (const char* section : kSections) {
    const Json* value = study.config.json().find(section);
    if (value) add_leaves(section, *value, result);
  }
  if (study.gravity != kGravity) result.emplace_back("gravity", number_text(study.gravity, 6));
  std::erase_if(result, [](const auto& entry) { return entry.first == "design.points"; });
  return result;
}

}  // namespace

std::string campaign_program() { return std::string(program_version()) + " (" + program_revision() + ")"; }

CampaignRequest plan_campaign(const Study& study, const std::filesystem::path& folder, int workers,
                              const InputFiles& inputs, const std::string& backend) {
  CampaignRequest request;
  request.folder = folder;
  request.design = make_design(read_design(study.section("design"), study.seed));
  Provenance& provenance = request.provenance;
  provenance.study = relevant_study(study).dump(2);
  provenance.contract_hash = content_hash(contract_text());
  provenance.program_version = campaign_program();
  provenance.backend = backend;
  const auto add_input = [&](const std::string& name, const std::filesystem::path& path) {
    provenance.inputs.emplace_back(name, file_hash(path));
    provenance.files.emplace_back(name, read_file(path));
  };
  if (!study.vehicle.empty()) add_input("vehicle", study.vehicle);
  for (const auto& [name, path] : inputs) add_input(name, path);
  provenance.libraries = {{"compiler", __VERSION__}, {"libc", gnu_get_libc_version()}};
  request.depends_on = dependencies(study, provenance);
  request.workers = workers;
  request.worker_command = {"/proc/self/exe", "campaign", "worker", study.file.string()};
  return request;
}

}  // namespace gonogo::campaign
