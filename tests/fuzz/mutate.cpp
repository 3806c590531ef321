#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <random>

namespace gonogo::fuzz {
namespace {

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t n) { return n == 0 ? 0 : std::size_t(random() % n); }

void put_number(std::string& bytes, Random& random) {
  constexpr std::array<std::uint32_t, 8> odd = {0, 1, 0x7f, 0xff, 0x7fff, 0x7fffffff, 0x80000000u, 0xffffffffu};
  const std::uint32_t value = odd[below(random, odd.size())];
  const std::size_t at = below(random, bytes.size()), width = std::size_t(1) << below(random, 3);
  for (std::size_t k = 0; k < width && at + k < bytes.size(); ++k) bytes[at + k] = char(value >> (8 * k));
}

void change_block(std::string& bytes, Random& random) {
  const std::size_t at = below(random, bytes.size()), length = std::min(1 + below(random, 64), bytes.size() - at);
  const std::size_t kind = below(random, 3);
  if (kind == 0)
    bytes.erase(at, length);
  else if (kind == 1)
    bytes.insert(at, bytes.substr(at, length));
  else
    std::fill_n(bytes.begin() + std::ptrdiff_t(at), length, '\0');
}

/// For files of text: another sign where a digit, a separator or a quote was.
void change_sign(std::string& bytes, Random& random) {
  constexpr std::string_view signs = "0123456789-+.eE,;:\"'<>/[]{}\n\r\t #NnIi";
  const std::size_t begin = below(random, bytes.size());
  for (std::size_t k = 0; k < 200 && k < bytes.size(); ++k) {
    char& c = bytes[(begin + k) % bytes.size()];
    if (signs.find(c) == std::string_view::npos) continue;
    c = signs[below(random, signs.size())];
    return;
  }
}

}  // namespace

Mutation mutated(const std::string& whole, std::uint64_t number) {
  Random random(0x9e3779b97f4a7c15u * (number + 1));
  Mutation m{.bytes = whole};
  if (below(random, 5) == 0) {
    m.is_cut = true;
    m.bytes.resize(below(random, whole.size()));
    return m;
  }
  for (std::size_t faults = 1 + below(random, 4); faults > 0 && !m.bytes.empty(); --faults) {
    switch (below(random, 4)) {
      case 0:
        m.bytes[below(random, m.bytes.size())] ^= char(1 << below(random, 8));
        break;
      case 1:
        put_number(m.bytes, random);
        break;
      case 2:
        change_block(m.bytes, random);
        break;
      default:
        change_sign(m.bytes, random);
    }
  }
  return m;
}

}  // namespace gonogo::fuzz
