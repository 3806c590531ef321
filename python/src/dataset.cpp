#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/export.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/study/task_variables.h"
#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

/// Column name -> array [rows], in the order of the program's CSV.
nb::typed<nb::dict, nb::str, nb::any> columns_of(const campaign::Dataset& dataset) {
  campaign::TrialColumns columns(dataset.records.size());
  for (const campaign::TrialRecord& record : dataset.records) columns.append(record);
  const campaign::Contract& contract = campaign::contract();
  const bool with_task = campaign::has_task_values(dataset.records);
  nb::dict result;
  result["index"] = array_of(std::move(columns.index));
  result["seed"] = array_of(std::move(columns.seed));
  result["replicate_of"] = array_of(std::move(columns.replicate_of));
  result["proposal_density"] = array_of(std::move(columns.proposal_density));
  for (std::size_t v = 0; v < contract.variables.size(); ++v)
    if (campaign::has_column(contract.variables[v], with_task))
      result[contract.variables[v].name.c_str()] = array_of(std::move(columns.variables[v]));
  result["verdict"] = array_of(std::move(columns.verdict));
  result["reason"] = array_of(std::move(columns.reason));
  result["attempts"] = array_of(std::move(columns.attempts));
  result["failed_checks"] = array_of(std::move(columns.failed_checks));
  for (std::size_t k = 0; k < contract.measures.size(); ++k)
    result[contract.measures[k].name.c_str()] = array_of(std::move(columns.measures[k]));
  return result;
}

std::string provenance_json(const campaign::Dataset& dataset) {
  const campaign::Provenance& p = dataset.provenance;
  const auto object = [](const campaign::Provenance::Pairs& pairs) {
    Json json = Json::object();
    for (const auto& [name, value] : pairs) json[name] = value;
    return json;
  };
  Json json;
  json["study"] = Json::parse(p.study.empty() ? "null" : p.study, "study");
  json["contract_hash"] = p.contract_hash;
  json["program_version"] = p.program_version;
  json["backend"] = p.backend;
  json["inputs"] = object(p.inputs);
  json["libraries"] = object(p.libraries);
  return json.dump();
}

}  // namespace

void bind_dataset(nb::module_& m) {
  m.def("names_of_checks", &campaign::names_of_checks, nb::arg("bits"), "\"residual+energy\", or \"none\".");
  nb::class_<campaign::Dataset>(m, "Dataset", "Trials of a campaign, one row each.")
      .def_static(
          "read", [](const std::string& path) { return long_call([&] { return campaign::read_dataset(path); }); },
          nb::arg("path"))
      .def("__len__", [](const campaign::Dataset& d) { return d.records.size(); })
      .def("columns", &columns_of, "Column name -> array [rows].")
      .def(
          "csv", [](const campaign::Dataset& d) { return long_call([&] { return campaign::to_csv(d); }); },
          "Header and one line per trial.")
      .def(
          "write",
          [](const campaign::Dataset& d, const std::string& path) {
            long_call([&] { campaign::write_dataset(path, d); });
          },
          nb::arg("path"), "Writes the HDF5 file.")
      .def(
          "summary",
          [](const campaign::Dataset& d) { return campaign::to_json(campaign::summarise(d.records)).dump(); },
          "JSON of counts, ranges and the agreement of replicates.")
      .def("provenance", &provenance_json, "JSON of what the rows depend on.");
}

}  // namespace gonogo::python
