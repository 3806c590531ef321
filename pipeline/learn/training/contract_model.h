// Model files as models of this program's contract.
#pragma once
#include <filesystem>
#include <string>

#include "learning/model/model.h"

namespace gonogo::learn {

/// Reads a model. Variables of tasks (pipeline/campaign/study/task_variables.h) that it lacks are added: 0 in all its
/// trials, without units. Throws InputError for a file that is missing, damaged, no model or of another contract.
learning::Model read_contract_model(const std::filesystem::path& file);

/// Throws InputError, beginning with `source`, unless variables and outcomes are the contract's.
void check_contract(const learning::Model& model, const std::string& source);

}  // namespace gonogo::learn
