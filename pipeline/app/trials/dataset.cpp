#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/campaign/dataset/check.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/map/rivals.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/importance/dataset_report.h"
#include "pipeline/report/figure/captioned.h"

namespace gonogo::app {
namespace {

struct DatasetOptions {
  std::string dataset, other, format = "csv", out, model, x = "slope_along", y = "friction_angle";
  std::vector<std::string> parts;
  std::uint64_t trial = 0;
  bool by_reason = false;
};

void add_summary(CLI::App& parent, const Globals& globals) {
  CLI::App* command =
      parent.add_subcommand("summary", "Counts, ranges, failed trials, replicates, share of go over slope");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5)")->required();
  add_examples(*command, {"gonogo dataset summary out/demo/dataset.h5"});
  command->callback([options, &globals] {
    const campaign::DatasetSummary summary = campaign::summarise(campaign::read_dataset(options->dataset).records);
    print_result(globals, campaign::to_json(summary), campaign::to_text(summary));
  });
}

void add_export(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("export", "The whole table for other programs, every number exact");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5)")->required();
  command->add_option("--format", options->format, "csv, or json with units and provenance")
      ->check(CLI::IsMember({"csv", "json"}))
      ->capture_default_str();
  add_named(*command, "--out", options->out, kFile, "File to write")->required();
  add_examples(*command, {"gonogo dataset export out/demo/dataset.h5 --format csv --out trials.csv"});
  command->callback([options, &globals] {
    const campaign::Dataset dataset = campaign::read_dataset(options->dataset);
    const std::string text = options->format == "csv" ? campaign::to_csv(dataset) : campaign::to_json_text(dataset);
    write_file_atomically(options->out, text);
    Json result = Json::object();
    result["out"] = options->out;
    result["trials"] = std::uint64_t(dataset.records.size());
    result["hash"] = content_hash(text);
    print_result(globals, result, options->out + ": " + std::to_string(dataset.records.size()) + " trials");
  });
}

/// A row of every valid trial: variables in the family's numbers, whether it passed, forecasts.
std::string forecasts_csv(const map::TrainedModel& family, const map::AnsweredTrials& asked) {
  std::string text;
  for (const campaign::Variable& variable : campaign::contract().variables) text += variable.name + ",";
  text += "passed,p_go";
  for (const std::string& name : map::rival_names()) text += "," + name;
  text += "\n";
  for (std::size_t n = 0; n < asked.trials.records.size(); ++n) {
    const campaign::TrialRecord& trial = asked.in_model.records[n];
    if (trial.verdict == campaign::Verdict::unknown) continue;
    for (const double value : trial.point.variables) text += line("%.17g,", value);
    text += line("%d,%.6g", campaign::passes(trial.verdict),
                 asked.predictor->p_go(asked.trials.records[n].point.variables));
    for (const double margin : map::rival_margins(trial.point.variables, family.family->diameter))
      text += line(",%.5f", margin);
    text += "\n";
  }
  return text;
}

void add_forecasts(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand(
      "forecasts",
      "Every trial in the numbers of a family, with forecasts of its model and of semi-empirical relations");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5) of a vehicle, or of the family")->required();
  add_named(*command, "--model", options->model, kModel, "Model of a family of whole vehicles")->required();
  add_named(*command, "--out", options->out, kFile, "Table to write (CSV)")->required();
  add_examples(*command,
               {"gonogo dataset forecasts data/hmmwv_32mm_fresh/dataset.h5 --model out/family/model.h5 --out t.csv"});
  command->callback([options, &globals] {
    const map::TrainedModel family = map::read_trained_model(map::find_model(options->model));
    if (!family.family)
      throw InputError(options->model + ": is no model of a family of vehicles with its trials beside it; give one");
    const map::AnsweredTrials asked = map::answer_trials(family, options->dataset);
    const campaign::Dataset& trials = asked.trials;
    write_file_atomically(options->out, forecasts_csv(family, asked));
    Json result = Json::object();
    result["out"] = options->out;
    result["trials"] = std::uint64_t(trials.records.size());
    print_result(globals, result, options->out + ": " + std::to_string(trials.records.size()) + " trials");
  });
}

void add_merge(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("merge", "Several datasets of one study as one, each trial once");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "datasets", options->parts, kFile, "Datasets (HDF5)")->required()->expected(2, -1);
  add_named(*command, "--out", options->out, kFile, "File to write")->required();
  add_examples(*command, {"gonogo dataset merge out/a/dataset.h5 out/b/dataset.h5 --out all.h5"});
  command->callback([options, &globals] {
    std::vector<campaign::Dataset> parts;
    for (const std::string& file : options->parts) parts.push_back(campaign::read_dataset(file));
    const campaign::Dataset merged = campaign::merge_datasets(parts, options->parts);
    campaign::write_dataset(options->out, merged);
    Json result = Json::object();
    result["out"] = options->out;
    result["trials"] = std::uint64_t(merged.records.size());
    print_result(globals, result, options->out + ": " + std::to_string(merged.records.size()) + " trials");
  });
}

/// Prints the result; throws DeviceError `fault` when it is not good.
void conclude(const Globals& globals, const Json& result, const std::string& text, bool good,
              const std::string& fault) {
  if (!good) fail_with_result(globals, result, text, DeviceError(fault));
  print_result(globals, result, text);
}

void add_verify(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("verify", "Check a dataset: hash, order, ranges, outcomes, replicates");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5)")->required();
  add_examples(*command, {"gonogo dataset verify out/demo/dataset.h5"});
  command->callback([options, &globals] {
    const campaign::Dataset dataset = campaign::read_dataset(options->dataset);
    const std::vector<std::string> faults = campaign::faults_of(dataset);
    Json result = Json::object();
    result["trials"] = std::uint64_t(dataset.records.size());
    result["faults"] = Json::array();
    std::string text;
    for (const std::string& fault : faults) {
      result["faults"].push_back(fault);
      text += fault + "\n";
    }
    if (faults.empty()) text = options->dataset + ": " + std::to_string(dataset.records.size()) + " trials, sound\n";
    conclude(globals, result, text, faults.empty(),
             options->dataset + ": " + std::to_string(faults.size()) + " faults; run its campaign again");
  });
}

void add_diff(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("diff",
                                            "Compare two datasets bit for bit, and verdicts and measures of the "
                                            "same points; exit status 1 when bits differ");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "first", options->dataset, kFile, "Dataset (HDF5)")->required();
  add_named(*command, "second", options->other, kFile, "Dataset (HDF5)")->required();
  add_examples(*command,
               {"gonogo dataset diff out/cpu/dataset.h5 out/gpu/dataset.h5",
                "gonogo dataset diff data/hmmwv_32mm_unsolved/fresh.h5 data/hmmwv_32mm_unsolved/fresh_rolling.h5"});
  command->callback([options, &globals] {
    const campaign::Dataset first = campaign::read_dataset(options->dataset),
                            second = campaign::read_dataset(options->other);
    const campaign::DatasetDifference d = campaign::difference(first, second);
    const campaign::PairedTrials pairs = campaign::paired(first, second);
    Json result = Json::object();
    result["same"] = d.none();
    result["common"] = std::uint64_t(d.common);
    result["only_first"] = std::uint64_t(d.only_first.size());
    result["only_second"] = std::uint64_t(d.only_second.size());
    result["different_values"] = std::uint64_t(d.rows.size());
    result["paired"] = campaign::to_json(pairs);
    conclude(globals, result, campaign::to_text(d) + (d.none() ? "" : campaign::to_text(pairs)), d.none(),
             options->dataset + " and " + options->other + " differ");
  });
}

void add_replay(CLI::App& parent, const Globals& globals) {
  CLI::App* command =
      parent.add_subcommand("replay", "Compute one trial again from the dataset alone; exit status 1 when bits differ");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5)")->required();
  command->add_option("--trial", options->trial, "Index of the trial")->required();
  add_examples(*command, {"gonogo dataset replay out/demo/dataset.h5 --trial 31"});
  command->callback([options, &globals] {
    const campaign::Replay replay =
        campaign::replay_trial(campaign::read_dataset(options->dataset), options->trial, globals.threads);
    Json result = Json::object();
    result["trial"] = options->trial;
    result["same"] = replay.differences.empty();
    result["same_program"] = replay.same_program;
    result["verdict"] = campaign::contract().info(replay.record.verdict).name;
    std::string text;
    for (const campaign::RowDifference& row : replay.differences)
      text += row.column + ": " + row.first + " in the dataset, " + row.second + " now\n";
    if (text.empty()) text = "trial " + std::to_string(options->trial) + ": the same bits\n";
    if (!replay.same_program) text += "the dataset was made by another version of the program\n";
    conclude(globals, result, text, replay.differences.empty(), "the trial did not end as in the dataset");
  });
}

void add_plot(CLI::App& parent, const Globals& globals) {
  CLI::App* command =
      parent.add_subcommand("plot", "Pictures and a page: go/no-go over two variables, pairs, importance");
  auto options = std::make_shared<DatasetOptions>();
  add_named(*command, "dataset", options->dataset, kFile, "Dataset (HDF5)")->required();
  add_named(*command, "--out", options->out, kFolder, "Folder for boundary.png, pairs.png, importance.png, report.html")
      ->required();
  add_named(*command, "--x", options->x, kVariable, "Variable or measure of the horizontal axis")
      ->capture_default_str();
  add_named(*command, "--y", options->y, kVariable, "Variable or measure of the vertical axis")->capture_default_str();
  command->add_flag("--by-reason", options->by_reason, "Colour trials that did not pass by their reason");
  add_named(*command, "--model", options->model, kModel, "Model trained on it, for the importance of variables");
  add_examples(*command, {"gonogo dataset plot out/demo/dataset.h5 --model out/demo/model.h5 --out out/demo/plots"});
  command->callback([options, &globals] {
    report::require_pictures("dataset plot");
    const campaign::Dataset dataset = campaign::read_dataset(options->dataset);
    outcome::ReportRequest request{
        .name = options->dataset, .x = options->x, .y = options->y, .by_reason = options->by_reason, .importance = {}};
    if (!options->model.empty())
      request.importance =
          outcome::model_importance(outcome::Predictor::read(map::find_model(options->model)), dataset);
    const auto files = outcome::write_dataset_report(options->out, dataset, request);
    Json result = Json::object();
    result["files"] = Json::array();
    std::string text;
    for (const auto& file : files) {
      result["files"].push_back(file.string());
      text += file.string() + "\n";
    }
    if (request.importance) {
      result["importance"] = outcome::to_json(*request.importance);
      text += "\n" + outcome::to_text(*request.importance);
    }
    print_result(globals, result, text);
  });
}

}  // namespace

void add_dataset_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("dataset", "Summarise, plot, check, compare, merge and export datasets");
  command->require_subcommand(1);
  add_examples(*command, {"gonogo dataset summary out/demo/dataset.h5"});
  add_summary(*command, globals);
  add_export(*command, globals);
  add_forecasts(*command, globals);
  add_merge(*command, globals);
  add_verify(*command, globals);
  add_diff(*command, globals);
  add_replay(*command, globals);
  add_plot(*command, globals);
}

}  // namespace gonogo::app
