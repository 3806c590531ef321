// Reads text files line by line and word by word. Messages name file and line.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonogo::learning {

class TextLines {
 public:
  TextLines(std::string_view text, std::string source) : rest_(text), source_(std::move(source)) {}

  /// Advances to the next line with words. False at the end.
  bool next();
  std::string_view line() const { return line_; }  // without line end
  const std::vector<std::string_view>& words() const { return words_; }

  /// Word k as an integer in [low, high], or as a finite number. Throws InputError otherwise.
  std::int64_t integer(std::size_t k, std::int64_t low, std::int64_t high) const;
  double number(std::size_t k) const;
  void expect_words(std::size_t count) const;
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view rest_, line_;
  std::string source_;
  std::size_t number_ = 0;
  std::vector<std::string_view> words_;
};

/// Parses the whole text as a finite number, with optional sign and exponent. False otherwise.
bool parse_number(std::string_view text, double& value);

}  // namespace gonogo::learning
