#include "learning/qubo/bytes.h"

namespace gonogo::learning {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

int digit_value(char c) {
  const char* found = c == 0 ? nullptr : std::strchr(kDigits, c);
  return found ? int(found - kDigits) : -1;
}

}  // namespace

std::string base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? std::uint32_t(static_cast<unsigned char>(bytes[at + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string from_base64(std::string_view text, const std::string& where) {
  if (text.size() % 4 != 0)
    throw InputError(where + ": " + std::to_string(text.size()) +
                     " characters of base64; there must be a multiple of 4");
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const bool last = at + 4 == text.size();
    const int padding = !last ? 0 : text[at + 3] != '=' ? 0 : text[at + 2] != '=' ? 1 : 2;
    std::uint32_t group = 0;
    for (int k = 0; k < 4; ++k) {
      const int value = k >= 4 - padding ? 0 : digit_value(text[at + std::size_t(k)]);
      if (value < 0)
        throw InputError(where + ": character " + std::to_string(at + std::size_t(k)) + " is not one of base64");
      group = group << 6 | std::uint32_t(value);
    }
    for (int k = 0; k < 3 - padding; ++k) bytes += char(group >> (16 - 8 * k) & 255);
    if (padding > 0 && (group & ((1u << (8 * padding)) - 1)) != 0)
      throw InputError(where + ": the last character of the base64 text carries bits that belong nowhere");
  }
  return bytes;
}

}  // namespace gonogo::learning
