// Damage to the bytes of a file, the same for the same number.
#pragma once
#include <cstdint>
#include <string>

namespace gonogo::fuzz {

struct Mutation {
  std::string bytes;
  bool is_cut = false;  // only the end is missing
};

/// One to four faults: bits turned, bytes and whole numbers replaced, blocks taken out, doubled or zeroed, digits
/// changed. One in five cuts the end off instead.
Mutation mutated(const std::string& whole, std::uint64_t number);

}  // namespace gonogo::fuzz
