#include <memory>

#include "base/file.h"
#include "base/hash.h"
#include "pipeline/cli/command.h"
#include "pipeline/dataset/export.h"
#include "pipeline/dataset/summary.h"

namespace gonogo::pipeline::cli {
namespace {

struct Options {
  std::string dataset, format = "csv", out;
};

void add_summary(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("summary", "Counts, ranges, failed trials, replicates, go against slope");
  auto options = std::make_shared<Options>();
  command->add_option("dataset", options->dataset, "Dataset (HDF5)")->required();
  command->footer("Example:\n  gonogo dataset summary out/demo/dataset.h5");
  command->callback([options, &globals] {
    const DatasetSummary summary = summarise(read_dataset(options->dataset).records);
    print_result(globals, to_json(summary), to_text(summary));
  });
}

void add_export(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("export", "The whole table for other programs, every number exact");
  auto options = std::make_shared<Options>();
  command->add_option("dataset", options->dataset, "Dataset (HDF5)")->required();
  command->add_option("--format", options->format, "csv, or json with units and provenance")
      ->check(CLI::IsMember({"csv", "json"}))
      ->capture_default_str();
  command->add_option("--out", options->out, "File to write")->required();
  command->footer("Example:\n  gonogo dataset export out/demo/dataset.h5 --format csv --out trials.csv");
  command->callback([options, &globals] {
    const Dataset dataset = read_dataset(options->dataset);
    const std::string text = options->format == "csv" ? to_csv(dataset) : to_json_text(dataset);
    write_file_atomically(options->out, text);
    Json result = Json::object();
    result["out"] = options->out;
    result["trials"] = std::uint64_t(dataset.records.size());
    result["hash"] = content_hash(text);
    print_result(globals, result, options->out + ": " + std::to_string(dataset.records.size()) + " trials");
  });
}

}  // namespace

void add_dataset_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("dataset", "Look into a dataset or export it");
  command->require_subcommand(1);
  command->footer("Example:\n  gonogo dataset summary out/demo/dataset.h5");
  add_summary(*command, globals);
  add_export(*command, globals);
}

}  // namespace gonogo::pipeline::cli
