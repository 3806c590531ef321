// A campaign over all variables of the contract, without a study file.
#pragma once
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/campaign.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

inline CampaignRequest cheap_campaign(const std::filesystem::path& folder, int points) {
  DesignSpec spec{.method = "sobol",
                  .seed = 3,
                  .points = std::uint64_t(points),
                  .replicate_every = 10,
                  .ranges = {},
                  .fixed = std::vector<double>(contract().variables.size(), 0.0)};
  for (std::size_t i = 0; i < contract().variables.size(); ++i)
    spec.ranges.push_back({i, contract().variables[i].minimum, contract().variables[i].maximum});
  CampaignRequest request;
  request.folder = folder;
  request.design = make_design(spec);
  request.depends_on = {{"seed", "3"}, {"trial.step_s", "0.001"}};
  request.provenance = {.study = "{}",
                        .contract_hash = "c",
                        .program_version = "p",
                        .backend = "cpu",
                        .inputs = {},
                        .libraries = {},
                        .files = {}};
  return request;
}

/// The dataset of an undisturbed campaign, from trials called in a loop: no worker, journal, shard or process involved.
inline std::string expected_bytes(int points) {
  const CampaignRequest request = cheap_campaign("unused", points);
  Dataset dataset{.records = {}, .provenance = request.provenance};
  for (const DesignPoint& point : request.design) dataset.records.push_back(closed_form_trial(point));
  return dataset_image(dataset);
}

}  // namespace gonogo::campaign
