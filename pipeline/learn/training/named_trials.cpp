#include "pipeline/learn/training/named_trials.h"

#include <algorithm>

#include "base/hash.h"
#include "base/nearest.h"
#include "base/shipped.h"

namespace gonogo::learn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "with";
constexpr const char* kFile = "dataset.h5";

fs::path find_trials(const Config& section, const std::string& name) {
  fs::path file = section.file().parent_path() / name;
  if (fs::is_regular_file(file)) return file;
  std::vector<std::string> names;
  for (const fs::path& folder : shipped_data_folders(kFile)) {
    if (folder.filename() == name) return folder / kFile;
    names.push_back(folder.filename().string());
  }
  if (name.find('/') != std::string::npos || fs::path(name).extension() == ".h5")
    section.fail(kKey, "\"" + name + "\": there is no file " + file.string() + "; name a dataset.h5 that exists");
  if (names.empty()) section.fail(kKey, "\"" + name + "\": no trials ship beside this program; name a file");
  section.fail(kKey, "\"" + name + "\": no shipped trials have that name (did you mean \"" + nearest_word(name, names) +
                         "\"?); there are: " + join_words(names));
}

}  // namespace

std::vector<fs::path> named_trials(const std::optional<Config>& section) {
  std::vector<fs::path> files;
  if (!section || !section->has(kKey)) return files;
  for (const std::string& name : section->texts(kKey)) {
    fs::path file = find_trials(*section, name);
    const bool is_twice =
        std::any_of(files.begin(), files.end(), [&](const fs::path& other) { return fs::equivalent(other, file); });
    if (is_twice) section->fail(kKey, "\"" + name + "\" is given twice; name each dataset once");
    files.push_back(std::move(file));
  }
  return files;
}

fs::path shipped_trials(const std::string& hash) {
  for (const fs::path& folder : shipped_data_folders(kFile))
    if (file_hash(folder / kFile) == hash) return folder / kFile;
  return {};
}

}  // namespace gonogo::learn
