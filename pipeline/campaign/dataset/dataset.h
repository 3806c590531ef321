// The dataset: one row per trial, one HDF5 array per variable and measure, with unit, description and range beside it.
//
//   /design/{index, seed, replicate_of, proposal_density}   [rows]
//   /variables/<name>, /measures/<name>                     [rows], in the unit of their attribute "unit"; variables
//                                                           of tasks (contract.h) only where a trial has them
//   /outcome/{verdict, reason, attempts, failed_checks}     [rows]; attributes "names" and "codes" name codes and bits
//   /provenance/{study, inputs, files, libraries}           what the rows depend on
//
// Rows and provenance decide every byte: no times, hosts or numbers of workers.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/units.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

/// What the bits of the rows depend on.
struct Provenance {
  using Pairs = std::vector<std::pair<std::string, std::string>>;
  std::string study;            // JSON text of the study's parts that trials depend on
  std::string contract_hash;    // content_hash of contract_text()
  std::string program_version;  // release and revision
  std::string backend;          // "cpu" or "cuda"
  Pairs inputs;                 // name of a vehicle, soil or bed file -> its content hash
  Pairs libraries;              // compiler or library whose version can change bits -> version

  Pairs files;  // name of such a file -> its text, so that a trial can be repeated from the dataset alone

  bool operator==(const Provenance&) const = default;
};

struct Dataset {
  std::vector<TrialRecord> records;
  Provenance provenance;
};

/// The same table by columns, which takes less memory than records: millions of rows are merged in it.
struct TrialColumns {
  explicit TrialColumns(std::size_t expected_rows = 0);
  /// Throws InputError for a record whose lengths are not the contract's.
  void append(const TrialRecord& record);

  std::vector<std::uint64_t> index, seed;
  std::vector<std::int64_t> replicate_of;
  std::vector<double> proposal_density;
  std::vector<std::vector<double>> variables, measures;  // [variable or measure of the contract][row]
  std::vector<std::int32_t> verdict, reason;             // codes
  std::vector<std::uint64_t> attempts, failed_checks;
};

/// Writes the file atomically. Throws InputError for records whose lengths are not the contract's, DeviceError when the
/// file cannot be written.
void write_dataset(const std::filesystem::path& path, const Dataset& dataset);

/// The bytes that write_dataset writes.
std::string dataset_image(const Dataset& dataset);
std::string dataset_image(TrialColumns columns, const Provenance& provenance);

/// Throws InputError with file and place for a missing, truncated or damaged file. The same for a file whose variables,
/// measures, verdicts or reasons are not those of this contract.
Dataset read_dataset(const std::filesystem::path& path);

/// Text of a file that the trials depend on ("vehicle", "calibration", ...); null where the dataset does not hold it.
const std::string* input_text(const Provenance& provenance, const char* name);

/// What the study of a dataset sets for all of its trials. A study without a key has the value here, and so has a
/// dataset without a study.
struct TrialSettings {
  double gravity = kGravity;     // [m/s^2]
  bool compliant_tyres = false;  // see TrialSetup
  double wheel_rolling = 0;      // rolling friction of grains on wheels over that between grains [-]
};

/// `where` starts the messages. Throws InputError for a study that is no JSON and for a value out of range.
TrialSettings settings_of(const Provenance& provenance, const std::string& where);

}  // namespace gonogo::campaign
