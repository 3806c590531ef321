#include "pipeline/outcome/active/active_run.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/outcome/active/choose.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/training/train_model.h"

namespace gonogo::outcome {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kCandidates = 128;  // candidates for each point that is chosen
constexpr const char* kPointFile = "points.csv";

/// Number of points in the table; 0 if the file does not exist. Throws InputError for a table that cannot be read.
std::uint64_t listed_points(const fs::path& file, const campaign::DesignSpec& spec) {
  std::error_code ec;
  return fs::exists(file, ec) ? campaign::read_point_csv(file, spec.fixed).size() : 0;
}

/// Appends points to the table, or starts a new one. Columns: the sampled variables and proposal_density. Numbers read
/// back exactly. The file is replaced as a whole, so it is never half written.
void append_points(const fs::path& file, const campaign::DesignSpec& spec,
                   const std::vector<campaign::DesignPoint>& points) {
  std::error_code ec;
  std::string text;
  if (fs::exists(file, ec)) {
    text = read_file(file);
    if (!text.empty() && text.back() != '\n') text += '\n';
  } else {
    for (const campaign::SampledVariable& range : spec.ranges)
      text += campaign::contract().variables[range.variable].name + ",";
    text += "proposal_density\n";
  }
  for (const campaign::DesignPoint& point : points) {
    for (const campaign::SampledVariable& range : spec.ranges) text += line("%.17g,", point.variables[range.variable]);
    text += line("%.17g\n", point.proposal_density);
  }
  write_file_atomically(file, text);
}

/// study: the one of the table.
Predictor train(const campaign::Study& study, const fs::path& folder, const fs::path& dataset,
                const std::shared_ptr<const Forecast>& forecast) {
  const fs::path model = folder / "model.h5";
  train_model({.dataset = dataset,
               .model = model,
               .seed = study.seed,
               .learning = study.config.object_if("learning"),
               .design = study.config.object_if("design"),
               .forecast = forecast});
  return Predictor::read(model);
}

std::vector<campaign::DesignPoint> first_batch(campaign::DesignSpec spec, const ActiveRequest& request) {
  const std::uint64_t count = request.seeds;
  if (request.forecast)
    return choose_batch(spec, answers_of(*request.forecast),
                        {.count = count, .space_filling = request.space_filling, .candidates = kCandidates * count});
  spec.method = "sobol";
  spec.points = count;
  spec.replicate_every = 0;
  return campaign::make_design(spec);
}

Json design_of_table(const campaign::DesignSpec& box, const Config& section) {
  Json design = Json::object(), ranges = Json::object(), fixed = Json::object();
  for (const campaign::SampledVariable& range : box.ranges)
    ranges[campaign::contract().variables[range.variable].name] = std::vector<double>{range.minimum, range.maximum};
  for (std::size_t i = 0; i < box.fixed.size(); ++i)
    if (!std::isnan(box.fixed[i])) fixed[campaign::contract().variables[i].name] = box.fixed[i];
  design["method"] = "csv";
  design["file"] = kPointFile;
  design["replicate_every"] = section.integer_or("replicate_every", 10, {0, 4e9});
  design["ranges"] = ranges;
  design["fixed"] = fixed;
  return design;
}

/// The study whose design is the table of chosen points, in the campaign's folder: what workers and a later call read.
campaign::Study study_of_table(const ActiveRequest& request, const campaign::DesignSpec& box) {
  Json json = request.study.config.json();
  json["design"] = design_of_table(box, request.study.section("design"));
  // Points crowd where the verdict changes. Weights prior / proposal would make just these count little
  // (docs/campaigns.md).
  Json& learning = json["learning"];
  if (learning.is_null() || !learning.find("importance")) learning["importance"] = 0;
  if (!request.study.vehicle.empty()) json["vehicle"] = fs::absolute(request.study.vehicle).string();
  if (!request.study.region.empty()) json["region"] = fs::absolute(request.study.region).string();
  json["soil"]["calibration"] = fs::absolute(request.study.section("soil").path("calibration")).string();
  const fs::path file = request.folder / "study.json";
  write_file_atomically(file, json.dump(2) + "\n");
  return campaign::read_study(file);
}

}  // namespace

ActiveSummary run_active(const ActiveRequest& request) {
  const campaign::DesignSpec box = campaign::read_design_box(request.study.section("design"), request.study.seed);
  fs::create_directories(request.folder);
  const fs::path file = request.folder / kPointFile;
  ActiveSummary summary;
  if (listed_points(file, box) == 0) append_points(file, box, first_batch(box, request));
  const campaign::Study study = study_of_table(request, box);
  for (;;) {
    summary.points = listed_points(file, box);
    const std::size_t computed = summary.campaign.computed;
    summary.campaign = campaign::run_campaign(campaign::plan_study_campaign(study, request.folder, request.compute));
    summary.campaign.computed += computed;
    summary.campaign.reused = summary.campaign.trials - summary.campaign.computed;
    const Predictor predictor = train(study, request.folder, summary.campaign.dataset, request.forecast);
    summary.confidence = 1 - expected_error(box, answers_of(predictor));
    summary.reached = summary.confidence >= request.confidence;
    log_line("active", line("%llu points: the model expects to be right in %.1f %% of the box",
                            static_cast<unsigned long long>(summary.points), 100 * summary.confidence));
    if (summary.reached || summary.points >= request.max_points) return summary;
    const std::uint64_t count = std::min(request.batch, request.max_points - summary.points);
    append_points(file, box,
                  choose_batch(box, answers_of(predictor),
                               {.count = count,
                                .space_filling = request.space_filling,
                                .skip = kCandidates * summary.points,
                                .candidates = kCandidates * count}));
  }
}

}  // namespace gonogo::outcome
