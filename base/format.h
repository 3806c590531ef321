// Text: numbers as people read them and as files hold them, formatted lines, and the word that was probably meant.
#pragma once
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gonogo {

/// Decimal text without trailing zeros: "0.09", "12.5", "1230", "-45". Decimals beyond `digits` significant digits are
/// rounded away; digits before the point are all kept. Below 1e-4 and from 1e7 on in size with an exponent: "2e-08".
/// NaN and infinities are "NaN", "infinity" and "-infinity".
std::string number_text(double x, int digits = 3);

/// printf into a string, for lines of reports and tables. Cuts the text off after 400 characters.
__attribute__((format(printf, 1, 2))) inline std::string line(const char* format, ...) {
  char text[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

/// Number of single-character insertions, deletions and substitutions between two words (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The first of `words` that begins with `misspelt`, if that has three letters or more. Otherwise the first with the
/// smallest edit distance; empty when there are no words.
std::string nearest_word(std::string_view misspelt, const std::vector<std::string>& words);

/// The number that all of `text` is; nothing for other text.
template <class T>
std::optional<T> parsed(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// "a, b, c"
std::string join_words(const std::vector<std::string>& words);

/// Bytes as text (RFC 4648, section 4).
std::string base64(std::string_view bytes);

}  // namespace gonogo
