#include "learning/qubo/text_lines.h"

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {

bool parse_number(std::string_view text, double& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty()) {
    if (rest_.empty()) {
      line_ = {};
      return false;
    }
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
    ++number_;
    constexpr const char* spaces = " \t\f\v";
    for (std::size_t at = line_.find_first_not_of(spaces); at != std::string_view::npos;) {
      const std::size_t stop = std::min(line_.find_first_of(spaces, at), line_.size());
      words_.push_back(line_.substr(at, stop - at));
      at = line_.find_first_not_of(spaces, stop);
    }
  }
  return true;
}

std::int64_t TextLines::integer(std::size_t k, std::int64_t low, std::int64_t high) const {
  const std::string_view word = words_.at(k);
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc() || end != word.data() + word.size() || value < low || value > high)
    fail("expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) + ", found " +
         std::string(word));
  return value;
}

double TextLines::number(std::size_t k) const {
  double value = 0;
  if (!parse_number(words_.at(k), value)) fail("expected a finite number, found " + std::string(words_[k]));
  return value;
}

void TextLines::expect_words(std::size_t count) const {
  if (words_.size() != count)
    fail(std::to_string(count) + " values belong on this line, found " + std::to_string(words_.size()));
}

void TextLines::fail(const std::string& message) const {
  throw InputError(source_ + ": line " + std::to_string(number_) + ": " + message);
}

}  // namespace gonogo::learning
