// The dataset: one row per trial, one HDF5 array per variable and measure, with unit, description and range beside it.
//
//   /design/{index, seed, replicate_of, proposal_density}     [rows]
//   /variables/<name>, /measures/<name>                       [rows], in the unit of their attribute "unit"
//   /outcome/{verdict, reason, attempts}                      [rows]; codes, named by the attributes "names" and
//   "codes" /provenance/{study, inputs, libraries}                    what the rows depend on, and nothing else
//
// Rows and provenance decide every byte: no times, hosts or numbers of workers.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

/// What the bits of the rows depend on.
struct Provenance {
  using Pairs = std::vector<std::pair<std::string, std::string>>;
  std::string study;            // JSON text of the study's parts that trials depend on
  std::string contract_hash;    // content_hash of contract_text()
  std::string program_version;  // release and revision
  std::string backend;          // "cpu" or "cuda"
  Pairs inputs;                 // name of a vehicle, soil or bed file -> its content hash
  Pairs libraries;              // compiler or library whose version can change bits -> version

  bool operator==(const Provenance&) const = default;
};

struct Dataset {
  std::vector<TrialRecord> records;
  Provenance provenance;
};

/// Writes the file atomically. Throws InputError for records whose lengths are not the contract's, DeviceError when the
/// file cannot be written.
void write_dataset(const std::filesystem::path& path, const Dataset& dataset);

/// The bytes that write_dataset writes.
std::string dataset_image(const Dataset& dataset);

/// Throws InputError, naming file and place, for a missing, truncated or damaged file and for one whose variables,
/// measures, verdicts or reasons are not those of this program's contract.
Dataset read_dataset(const std::filesystem::path& path);

}  // namespace gonogo::pipeline
