// MD5 of RFC 1321, to compare bytes with sums that others published. Not for security.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace gonogo {

inline void md5_block(const unsigned char* block, std::uint32_t (&state)[4]) {
  constexpr int shift[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
  std::uint32_t word[16], a = state[0], b = state[1], c = state[2], d = state[3];
  for (int k = 0; k < 16; ++k)
    word[k] = std::uint32_t(block[4 * k]) | std::uint32_t(block[4 * k + 1]) << 8 |
              std::uint32_t(block[4 * k + 2]) << 16 | std::uint32_t(block[4 * k + 3]) << 24;
  for (int i = 0; i < 64; ++i) {
    const std::uint32_t mix[4] = {(b & c) | (~b & d), (d & b) | (~d & c), b ^ c ^ d, c ^ (b | ~d)};
    const int index[4] = {i, (5 * i + 1) % 16, (3 * i + 5) % 16, 7 * i % 16};
    const auto constant = std::uint32_t(std::floor(std::abs(std::sin(double(i + 1))) * 0x1p32));
    const std::uint32_t sum = a + mix[i / 16] + constant + word[index[i / 16]];
    const int s = shift[i / 16][i % 4];
    a = d;
    d = c;
    c = b;
    b += sum << s | sum >> (32 - s);
  }
  state[0] += a;
  state[1] += b;
  state[2] += c;
  state[3] += d;
}

/// 32 hexadecimal digits.
inline std::string md5(std::string_view text) {
  std::string bytes(text);
  bytes += char(0x80);
  while (bytes.size() % 64 != 56) bytes += '\0';
  for (int k = 0; k < 8; ++k) bytes += char(std::uint64_t(text.size()) * 8 >> (8 * k) & 255);
  std::uint32_t state[4] = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  for (std::size_t at = 0; at < bytes.size(); at += 64)
    md5_block(reinterpret_cast<const unsigned char*>(bytes.data()) + at, state);
  std::string digits;
  for (std::uint32_t value : state)
    for (int k = 0; k < 4; ++k) {
      char pair[3];
      std::snprintf(pair, sizeof pair, "%02x", value >> (8 * k) & 255);
      digits += pair;
    }
  return digits;
}

}  // namespace gonogo
