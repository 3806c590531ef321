#include "base/format.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace gonogo {

std::string number_text(double x, int digits) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x > 0 ? "infinity" : "-infinity";
  char text[64];
  const double size = std::fabs(x);
  if (size == 0) return "0";
  if (size < 1e-4 || size >= 1e7) {
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    return text;
  }
  const int decimals = std::max(0, digits - 1 - int(std::floor(std::log10(size))));
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  std::string plain = text;
  if (decimals > 0) plain.erase(plain.find_last_not_of('0') + 1);
  if (plain.back() == '.') plain.pop_back();
  return plain;
}

namespace {

constexpr std::size_t kBeginning = 3;  // letters that count as the beginning of a word

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

std::string nearest_word(std::string_view misspelt, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (misspelt.size() >= kBeginning && word.starts_with(misspelt)) return word;
  const auto nearest = std::min_element(words.begin(), words.end(), [&](const auto& a, const auto& b) {
    return edit_distance(a, misspelt) < edit_distance(b, misspelt);
  });
  return nearest == words.end() ? "" : *nearest;
}

std::string join_words(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? std::uint32_t(static_cast<unsigned char>(bytes[at + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace gonogo
