// Shows a dataset as pictures and as one HTML page that needs no network.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/outcome/importance/importance.h"

namespace gonogo::outcome {

struct ReportRequest {
  std::string name;                                           // of the dataset, for titles
  std::string x = "slope_along", y = "friction_angle";        // variables or measures of the large scatter
  bool by_reason = false;                                     // colours of trials that did not pass in boundary.png
  std::optional<std::vector<VariableImportance>> importance;  // of a model; none: no importance.png
};

/// Writes boundary.png (trials over x and y by verdict or reason), pairs.png (all varied variables), importance.png and
/// report.html, which embeds them. Returns the paths. Throws InputError for names that are neither variable nor
/// measure, and in a build without pictures. Throws DeviceError if a file cannot be written.
std::vector<std::filesystem::path> write_dataset_report(const std::filesystem::path& folder,
                                                        const campaign::Dataset& dataset, const ReportRequest& request);

}  // namespace gonogo::outcome
