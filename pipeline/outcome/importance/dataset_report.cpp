#include "pipeline/outcome/importance/dataset_report.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::outcome {
namespace fs = std::filesystem;
namespace {

template <class Entry, class Get>
report::ScatterColumn column_of(const campaign::Dataset& dataset, const Entry& entry, Get get) {
  report::ScatterColumn column{entry.name + " [" + entry.unit + "]", {}};
  for (const campaign::TrialRecord& record : dataset.records) column.values.push_back(get(record));
  return column;
}

report::ScatterColumn variable_column(const campaign::Dataset& dataset, std::size_t i) {
  return column_of(dataset, campaign::contract().variables[i],
                   [i](const campaign::TrialRecord& r) { return r.point.variables[i]; });
}

/// A variable or a measure.
report::ScatterColumn named_column(const campaign::Dataset& dataset, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < campaign::contract().variables.size(); ++i) {
    if (campaign::contract().variables[i].name == name) return variable_column(dataset, i);
    names.push_back(campaign::contract().variables[i].name);
  }
  for (std::size_t i = 0; i < campaign::contract().measures.size(); ++i) {
    if (campaign::contract().measures[i].name == name)
      return column_of(dataset, campaign::contract().measures[i],
                       [i](const campaign::TrialRecord& r) { return r.measures[i]; });
    names.push_back(campaign::contract().measures[i].name);
  }
  throw InputError("\"" + name + "\" is neither a variable nor a measure; did you mean \"" + nearest_word(name, names) +
                   "\"? Known: " + join_words(names));
}

report::ScatterTable table_of(const campaign::Dataset& dataset, const std::string& title) {
  report::ScatterTable table{.title = title, .columns = {}, .classes = {}, .class_of_row = {}};
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
    table.classes.push_back({verdict.label, verdict.colour});
  for (const campaign::TrialRecord& record : dataset.records) table.class_of_row.push_back(int(record.verdict) - 1);
  return table;
}

/// Trials that passed by verdict, the others by the reason; only reasons that occur.
report::ScatterTable table_by_reason(const campaign::Dataset& dataset, const std::string& title) {
  report::ScatterTable table{.title = title, .columns = {}, .classes = {}, .class_of_row = {}};
  std::map<std::pair<int, int>, int> class_of;  // (verdict, reason; 0 for those that passed) -> class
  for (const campaign::TrialRecord& record : dataset.records)
    class_of[{int(record.verdict), campaign::passes(record.verdict) ? 0 : int(record.reason)}] = 0;
  for (auto& [outcome, index] : class_of) {
    const campaign::VerdictInfo& verdict = campaign::contract().info(campaign::Verdict(outcome.first));
    index = int(table.classes.size());
    if (outcome.second == 0) {
      table.classes.push_back({verdict.label, verdict.colour});
    } else {
      const campaign::ReasonInfo& reason = campaign::contract().info(campaign::Reason(outcome.second));
      table.classes.push_back({verdict.label + ": " + reason.label, reason.colour});
    }
  }
  for (const campaign::TrialRecord& record : dataset.records)
    table.class_of_row.push_back(
        class_of.at({int(record.verdict), campaign::passes(record.verdict) ? 0 : int(record.reason)}));
  return table;
}

bool varies(const report::ScatterColumn& column) {
  return std::any_of(column.values.begin(), column.values.end(), [&](double x) { return x != column.values.front(); });
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return result;
}

std::string page(const std::string& title, const std::string& text, const std::vector<fs::path>& pictures) {
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(title) +
                     "</title>\n<style>body{font-family:sans-serif;max-width:1400px;margin:2em auto;padding:0 1em}"
                     "img{max-width:100%}pre{background:#f4f4f6;padding:1em;overflow:auto}</style></head>\n<body><h1>" +
                     escaped(title) + "</h1>\n<pre>" + escaped(text) + "</pre>\n";
  for (const fs::path& picture : pictures)
    html += "<p><img alt=\"" + picture.stem().string() + "\" src=\"data:image/png;base64," +
            base64(read_file(picture)) + "\"></p>\n";
  return html + "</body></html>\n";
}

report::Bars bars_of(const std::vector<VariableImportance>& importance) {
  report::Bars bars{.title = "What decides about go, by the model",
                    .labels = {},
                    .series = {"Sobol' total index of P(go)", "Brier score worse by, if shuffled"},
                    .values = {{}, {}}};
  for (const VariableImportance& v : importance) {
    bars.labels.push_back(v.name);
    bars.values[0].push_back(v.total_index);
    bars.values[1].push_back(v.permutation);
  }
  return bars;
}

}  // namespace

std::vector<fs::path> write_dataset_report(const fs::path& folder, const campaign::Dataset& dataset,
                                           const ReportRequest& request) {
  report::require_pictures("dataset report");
  report::ScatterTable boundary = request.by_reason ? table_by_reason(dataset, request.name + ": trials by reason")
                                                    : table_of(dataset, request.name + ": trials by verdict");
  boundary.columns = {named_column(dataset, request.x), named_column(dataset, request.y)};
  report::ScatterTable pairs = table_of(dataset, request.name + ": every pair of variables");
  if (dataset.records.empty()) throw InputError(request.name + ": holds no trial; there is nothing to draw");
  for (std::size_t i = 0; i < campaign::contract().variables.size(); ++i)
    if (report::ScatterColumn column = variable_column(dataset, i); varies(column))
      pairs.columns.push_back(std::move(column));
  create_folder(folder);
  std::vector<fs::path> files{folder / "boundary.png", folder / "pairs.png"};
  report::draw_scatter(files[0], boundary, 0, 1);
  report::draw_pairs(files[1], pairs);
  std::string text = campaign::to_text(campaign::summarise(dataset.records));
  if (request.importance) {
    files.push_back(folder / "importance.png");
    report::draw_bars(files.back(), bars_of(*request.importance));
    text += "\n" + to_text(*request.importance);
  }
  const std::string html = page(request.name, text, files);
  files.push_back(folder / "report.html");
  write_file_atomically(files.back(), html);
  return files;
}

}  // namespace gonogo::outcome
