// Variables that one type of trial alone has, such as the width of a ditch. Their prior in the contract is "task".
//
// Their name is that of the type and of the number: ditch_width is "width_m" of the type "ditch". A study gives such a
// number either in trial.task, for all trials, or as a variable of its design. In all other trials the variable is 0,
// which none of these numbers can be. Datasets and tables without any of them lack their columns, and old models too.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {

inline bool is_task_variable(const Variable& v) { return v.prior == "task"; }

/// Whether a table has a column for this variable. `with_task`: the table has the variables of tasks.
inline bool has_column(const Variable& v, bool with_task) { return with_task || !is_task_variable(v); }

/// Number of a task and the variable of the contract that may give it.
struct TaskNumber {
  std::string key;  // "width_m"
  std::size_t variable;
};

/// Of trials of this type; empty where no variable belongs to it.
std::vector<TaskNumber> task_numbers(const std::string& type);

/// Whether a variable of a task is set in a point, [contract().variables.size()].
bool has_task_values(std::span<const double> variables);

}  // namespace gonogo::campaign
