// The contract: every variable, measure, verdict and reason. It is read from configs/schema/variables.json, the only
// list of them, which is compiled into the program.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json/config.h"

namespace gonogo::campaign {

struct EncoderSpec {
  std::string code;  // "thermometer", "one_hot", "gray" or "binary"
  int bits = 0;
};

struct Variable {
  std::string name, label, unit;
  double minimum = 0, maximum = 0;  // [unit]
  std::string sets, source;         // target in the simulator; raster or table of its values
  std::string prior;                // "region", "uniform", "fixed", "task" or "family"
  EncoderSpec encoder;
};

struct Measure {
  std::string name, unit, about;
  std::string task = {};  // type of trial that alone has it; empty: every type has it
};

/// The enumerators' values are the raster codes; parse_contract() checks them against the schema.
enum class Verdict : int { go = 1, slow_go = 2, no_go = 3, unknown = 4 };
enum class Reason : int {
  none = 0,
  slope_unstable,
  rollover,
  slid_back,
  power,
  sinkage,
  traction,
  obstacle,
  timeout,
  simulation_failed,
  outside_sampled,
  input_missing,
  water,
  vegetation,
  built_up,
  land_unknown,
  soft_soil
};

/// The vehicle gets through, at whatever speed.
inline bool passes(Verdict v) { return v == Verdict::go || v == Verdict::slow_go; }

struct VerdictInfo {
  std::string name;
  int code;
  std::string label, colour, colour_blind_safe;
};

struct ReasonInfo {
  std::string name;
  int code;
  std::vector<std::string> verdicts;
  std::string label, colour, about;
  bool map_only = false;  // no trial ends with it
};

/// A (verdict, reason) pair that a valid trial can end with, one outcome unit of the learner each. Order: go/none,
/// slow_go/none, then no_go with each of its reasons. `unknown` is no outcome: it is a failed measurement.
struct Outcome {
  Verdict verdict;
  Reason reason;
  std::string name;  // "go", "slow_go", "no_go/traction", ...
};

class Contract {
 public:
  std::vector<Variable> variables;
  std::vector<Measure> measures;
  std::vector<VerdictInfo> verdicts;
  std::vector<ReasonInfo> reasons;
  std::vector<Outcome> outcomes;

  /// Position in `variables`; throws InputError naming the nearest valid name.
  std::size_t variable_index(const std::string& name) const;
  std::size_t measure_index(const std::string& name) const;
  /// Position in `outcomes`; throws InputError for pairs that are not outcomes (unknown).
  std::size_t outcome_index(Verdict verdict, Reason reason) const;
  const VerdictInfo& info(Verdict verdict) const;
  const ReasonInfo& info(Reason reason) const;
};

/// Reads a schema. `name` starts the messages. Throws InputError when a key is unknown or missing, a name appears
/// twice, or verdicts and reasons differ from the enumerators above.
Contract parse_contract(std::string_view text, const std::string& name);

/// The contract compiled into this program.
const Contract& contract();

/// The schema's text, byte for byte (hashed into provenance).
const std::string& contract_text();

// Variables that some trials alone have: those of one type of trial, such as the width of a ditch, and those of a
// family of vehicles, such as the width of its wheels. Their prior in the contract is "task" or "family".
//
// The name of a type's variable is that of the type and of its number: ditch_width is "width_m" of the type "ditch". A
// study gives such a number either in trial.task, for all trials, or as a variable of its design. A family's variables
// are in the design of a study whose vehicle is a family. In all other trials these variables are 0. Datasets and
// tables without any of them lack their columns, and old models too.

inline bool is_family_variable(const Variable& v) { return v.prior == "family"; }
inline bool is_task_variable(const Variable& v) { return v.prior == "task" || is_family_variable(v); }

/// Whether a trial may have this value: NaN, where it is unknown, and 0 of a variable that only some trials have.
inline bool admits(const Variable& v, double x) {
  return !(x < v.minimum || x > v.maximum) || (x == 0 && is_task_variable(v));
}

/// The number at `key`, refused unless a trial may have it.
double read_value(const Config& config, const std::string& key, const Variable& variable);

/// Whether a table has a column for this variable, or measure. `with_task`: the table has those of some trials alone.
inline bool has_column(const Variable& v, bool with_task) { return with_task || !is_task_variable(v); }
inline bool has_column(const Measure& m, bool with_task) { return with_task || m.task.empty(); }

/// Number of a task and the variable of the contract that may give it.
struct TaskNumber {
  std::string key;  // "width_m"
  std::size_t variable;
};

/// Numbers of this type of trial that are variables; empty where none is.
std::vector<TaskNumber> task_numbers(const std::string& type);

/// Whether a variable of a task is set in a point, [contract().variables.size()].
bool has_task_values(std::span<const double> variables);

}  // namespace gonogo::campaign
