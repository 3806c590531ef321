// Words of text files, line by line, with messages that name file and line.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gonogo::learning {

class TextLines {
 public:
  TextLines(std::string_view text, std::string source) : rest_(text), source_(std::move(source)) {}

  /// Goes to the next line with words on it; false at the end.
  bool next();
  std::string_view line() const { return line_; }  // without line end
  const std::vector<std::string_view>& words() const { return words_; }

  /// The k-th word as a whole number in [low, high], or a finite number; throws InputError otherwise.
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

/// Finite number that is the whole text; nothing otherwise. Decimal and exponent forms, sign allowed.
bool parse_number(std::string_view text, double& value);

}  // namespace gonogo::learning
