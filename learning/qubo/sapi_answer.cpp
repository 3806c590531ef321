#include <algorithm>

#include "base/error.h"
#include "learning/qubo/bytes.h"
#include "learning/qubo/json_reader.h"
#include "learning/qubo/python_json.h"
#include "learning/qubo/sapi.h"

namespace gonogo::learning {
namespace {

/// Columns of the samples by ascending qubit.
std::vector<std::pair<std::int64_t, std::size_t>> qubit_columns(const SampleSet& samples, std::int64_t chip_size) {
  std::vector<std::pair<std::int64_t, std::size_t>> columns;
  for (std::size_t k = 0; k < samples.labels.size(); ++k) {
    const auto* qubit = std::get_if<std::int64_t>(&samples.labels[k]);
    if (!qubit || *qubit < 0 || *qubit >= chip_size)
      throw InputError("answer: variable " + label_text(samples.labels[k]) + " is not a qubit below " +
                       std::to_string(chip_size));
    columns.emplace_back(*qubit, k);
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

std::string pack_rows(const SampleSet& samples, const std::vector<std::pair<std::int64_t, std::size_t>>& columns) {
  const std::size_t width = (columns.size() + 7) / 8;
  std::string bytes(samples.row_count() * width, '\0');
  for (std::size_t r = 0; r < samples.row_count(); ++r)
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (samples.row(r)[columns[k].second] > 0) bytes[r * width + k / 8] |= char(0x80 >> (k % 8));
  return bytes;
}

/// Bits of all rows; a decoder divides the bytes by the rows, so surplus bytes at the end of a row are allowed.
std::vector<std::int8_t> unpack_rows(const JsonReader& answer, const std::string& bytes, std::size_t rows,
                                     std::size_t variables, std::int8_t off) {
  if (rows == 0) {
    answer.expect_size("solutions", bytes.size(), 0);
    return {};
  }
  const std::size_t width = bytes.size() / rows;
  if (bytes.size() % rows != 0 || width < (variables + 7) / 8)
    answer.fail("solutions", std::to_string(bytes.size()) + " bytes cannot hold " + std::to_string(rows) + " rows of " +
                                 std::to_string(variables) + " bits");
  std::vector<std::int8_t> values;
  values.reserve(rows * variables);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < variables; ++k)
      values.push_back((bytes[r * width + k / 8] >> (7 - k % 8)) & 1 ? 1 : off);
  return values;
}

void check_status(const JsonReader& reader) {
  if (reader.find("error_msg")) reader.fail("error_msg", reader.text("error_msg"));
  if (!reader.find("status")) return;
  const std::string status = reader.text("status");
  if (status == "COMPLETED") return;
  reader.fail("status", "the problem is " + status +
                            (reader.find("error_message") ? ": " + reader.text("error_message") : "") +
                            "; only the answer of a COMPLETED problem can be read");
}

std::vector<std::int64_t> read_counts(const JsonReader& answer, const std::string& where, std::size_t rows) {
  if (!answer.find("num_occurrences")) return std::vector<std::int64_t>(rows, 1);
  const auto counts = numbers_from_base64<std::int32_t>(answer.text("num_occurrences"), where + "num_occurrences");
  answer.expect_size("num_occurrences", counts.size(), rows);
  for (std::int32_t count : counts)
    if (count < 1) answer.fail("num_occurrences", "a count of " + std::to_string(count) + "; counts start at 1");
  return {counts.begin(), counts.end()};
}

}  // namespace

std::string to_sapi_answer(const SampleSet& samples, std::int64_t chip_size, bool histogram, const Json& timing) {
  const auto columns = qubit_columns(samples, chip_size);
  if (histogram && !std::is_sorted(samples.energies.begin(), samples.energies.end()))
    throw InputError("answer: rows of a histogram answer must be ordered by energy");
  std::vector<std::int32_t> qubits, counts;
  for (const auto& column : columns) qubits.push_back(std::int32_t(column.first));
  for (std::int64_t count : samples.occurrences) {
    if (count < 1 || count > INT32_MAX || (!histogram && count != 1))
      throw InputError("answer: occurrences " + std::to_string(count) + " cannot be written in this answer mode");
    counts.push_back(std::int32_t(count));
  }
  Json json, answer;
  answer["format"] = "qp";
  answer["num_variables"] = Json(chip_size);
  answer["active_variables"] = base64(bytes_of(qubits));
  answer["energies"] = base64(bytes_of(samples.energies));
  if (histogram) answer["num_occurrences"] = base64(bytes_of(counts));
  answer["solutions"] = base64(pack_rows(samples, columns));
  answer["timing"] = timing;
  json["type"] = samples.vartype == Vartype::spin ? "ising" : "qubo";
  json["status"] = "COMPLETED";
  json["answer"] = std::move(answer);
  return python_json(json, JsonSpaces::after) + "\n";
}

SampleSet samples_from_sapi(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader reader(json, source, "");
  check_status(reader);
  const std::string type = reader.text("type"), where = source + ": answer.";
  if (type != "ising" && type != "qubo") reader.fail("type", "expected \"ising\" or \"qubo\", found \"" + type + "\"");
  const JsonReader answer = reader.object("answer");
  answer.expect_text("format", "qp");
  SampleSet samples;
  samples.vartype = type == "ising" ? Vartype::spin : Vartype::binary;
  const std::int64_t chip_size = answer.integer("num_variables", 0, INT32_MAX);
  std::int64_t next = 0;
  for (std::int32_t qubit :
       numbers_from_base64<std::int32_t>(answer.text("active_variables"), where + "active_variables")) {
    if (qubit < next || qubit >= chip_size)
      answer.fail("active_variables",
                  "qubit " + std::to_string(qubit) + " is out of order or not below " + std::to_string(chip_size));
    next = std::int64_t(qubit) + 1;
    samples.labels.emplace_back(std::int64_t(qubit));
  }
  samples.energies = numbers_from_base64<double>(answer.text("energies"), where + "energies");
  const double offset = answer.find("offset") ? answer.number("offset") : 0;
  for (double& energy : samples.energies) {
    if (!std::isfinite(energy)) answer.fail("energies", "an energy is not a finite number");
    energy += offset;
  }
  samples.occurrences = read_counts(answer, where, samples.row_count());
  samples.values = unpack_rows(answer, from_base64(answer.text("solutions"), where + "solutions"), samples.row_count(),
                               samples.variable_count(), samples.vartype == Vartype::binary ? 0 : -1);
  if (answer.find("timing")) samples.info["timing"] = answer.at("timing");
  return samples;
}

}  // namespace gonogo::learning
