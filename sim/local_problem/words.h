// A text file word by word, with errors that name file, line, value and expectation. Inside sim/local_problem.
#pragma once
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/file.h"

namespace gonogo::sim {

/// The words of a text file and their lines.
class Words {
 public:
  explicit Words(const std::filesystem::path& path) : name_(path.string()), content_(read_file(path)) {
    int line = 1;
    for (std::size_t at = 0; at < content_.size();) {
      const char c = content_[at];
      line += c == '\n';
      if (is_space(c)) {
        ++at;
        continue;
      }
      std::size_t end = at;
      while (end < content_.size() && !is_space(content_[end])) ++end;
      word_.push_back({std::string_view(content_).substr(at, end - at), line});
      at = end;
    }
  }

  const std::string& name() const { return name_; }
  std::size_t left() const { return word_.size() - next_; }
  int line() const { return next_ < word_.size() ? word_[next_].line : word_.empty() ? 1 : word_.back().line; }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ": line " + std::to_string(line()) + ": " + message);
  }

  std::string_view word(const std::string& what) {
    if (next_ >= word_.size()) fail("the file ends where " + what + " is needed; it is cut off or another format");
    return word_[next_++].text;
  }

  int integer(const std::string& what, int low, int high) {
    int value = 0;
    const std::string_view text = word(what);
    if (!parse(text, value) || value < low || value > high) {
      --next_;
      fail(what + " is \"" + std::string(text) + "\"; an integer from " + std::to_string(low) + " to " +
           std::to_string(high) + " is needed");
    }
    return value;
  }

  double number(const std::string& what) {
    double value = 0;
    const std::string_view text = word(what);
    if (!parse(text, value) || !std::isfinite(value)) {
      --next_;
      fail(what + " is \"" + std::string(text) + "\"; a finite number is needed");
    }
    return value;
  }

  std::vector<double> numbers(const std::string& what, int count) {
    require_left(what, count);
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(number(what + "[" + std::to_string(i) + "]"));
    return values;
  }

  void require_left(const std::string& what, double count) const {
    if (double(left()) < count)
      fail(what + " needs " + std::to_string(std::int64_t(count)) + " values, the file has only " +
           std::to_string(left()) + " more");
  }

  void expect(const std::string& text) {
    const std::string_view found = word("\"" + text + "\"");
    if (found != text) {
      --next_;
      fail("\"" + std::string(found) + "\" stands where \"" + text + "\" is needed");
    }
  }

  /// Takes a trailing comma off the next word.
  void drop_comma() {
    if (next_ < word_.size() && word_[next_].text.back() == ',') word_[next_].text.remove_suffix(1);
  }

  void skip_line() {
    for (const int here = line(); next_ < word_.size() && word_[next_].line == here;) ++next_;
  }

  /// Whether the next words are these integers.
  bool follows(const std::vector<int>& values) const {
    if (left() < values.size()) return false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      int value = 0;
      if (!parse(word_[next_ + i].text, value) || value != values[i]) return false;
    }
    return true;
  }

  bool next_on_line_of_previous() const {
    return next_ > 0 && next_ < word_.size() && word_[next_].line == word_[next_ - 1].line;
  }

 private:
  struct Word {
    std::string_view text;
    int line;
  };
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  template <class T>
  static bool parse(std::string_view text, T& value) {
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
  }

  std::string name_, content_;
  std::vector<Word> word_;
  std::size_t next_ = 0;
};

}  // namespace gonogo::sim
