// Trials that a study learns from beside its own: the key "with" of its section "learning", a list of datasets. Each is
// the name of a shipped folder data/<name>, or a file, relative to the study.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"

namespace gonogo::learn {

/// The files of "with" in the order of the list; none without the section or the key. Throws InputError for a file
/// that is not there, for an unknown name, with the nearest one, and for a dataset named twice.
std::vector<std::filesystem::path> named_trials(const std::optional<Config>& section);

/// The shipped dataset with this content hash; empty where none has it.
std::filesystem::path shipped_trials(const std::string& hash);

}  // namespace gonogo::learn
