#include "terrain/calibration/journal.h"

#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/json/config.h"

namespace gonogo::terrain {

TestJournal::TestJournal(std::filesystem::path path, std::string maker)
    : path_(std::move(path)), maker_(std::move(maker)) {
  if (path_.empty() || !std::filesystem::exists(path_)) return;
  const Config file = Config::read(path_);
  file.choice("schema", {"gonogo/soil_journal/1"});
  if (file.text("maker") != maker_)
    file.fail("maker", "these tests were made by another grain size, shape or version (" + file.text("maker") +
                           "); name another file or remove this one");
  for (const Config& test : file.objects("tests")) result_[test.text("name")] = test.numbers("numbers");
}

std::optional<std::vector<double>> TestJournal::find(const std::string& test) const {
  const std::lock_guard lock(mutex_);
  const auto found = result_.find(test);
  if (found == result_.end()) return std::nullopt;
  return found->second;
}

void TestJournal::add(const std::string& test, const std::vector<double>& numbers) {
  const std::lock_guard lock(mutex_);
  result_[test] = numbers;
  save();
}

void TestJournal::save() const {
  if (path_.empty()) return;
  Json j;
  j["schema"] = "gonogo/soil_journal/1";
  j["maker"] = maker_;
  j["tests"] = Json::array();
  for (const auto& [name, numbers] : result_) {
    Json test;
    test["name"] = name;
    test["numbers"] = numbers;
    j["tests"].push_back(test);
  }
  write_file_atomically(path_, j.dump(1) + "\n");
}

}  // namespace gonogo::terrain
