// Results of finished tests by name, in one JSON file that is replaced as a whole after every test.
#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace gonogo::terrain {

class TestJournal {
 public:
  /// `maker` describes all that the results depend on, apart from the tests' names. Throws InputError for a file of
  /// another maker.
  TestJournal(std::filesystem::path path, std::string maker);

  std::optional<std::vector<double>> find(const std::string& test) const;
  /// Thread-safe.
  void add(const std::string& test, const std::vector<double>& numbers);
  std::size_t size() const { return result_.size(); }

 private:
  void save() const;

  std::filesystem::path path_;
  std::string maker_;
  std::map<std::string, std::vector<double>> result_;
  mutable std::mutex mutex_;
};

}  // namespace gonogo::terrain
