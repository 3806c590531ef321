#include "base/hash.h"

#define XXH_INLINE_ALL  // header-only: no library to link
#include <xxhash.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <new>
#include <vector>

#include "base/error.h"

namespace gonogo {
namespace {

constexpr std::size_t kBlockBytes = 1 << 20;

std::string hexadecimal(XXH128_hash_t hash) {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace

std::string content_hash(std::string_view content) { return hexadecimal(XXH3_128bits(content.data(), content.size())); }

std::string file_hash(const std::filesystem::path& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
  if (std::filesystem::is_directory(path, ec)) throw InputError(path.string() + ": is a folder, a file is needed");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string() + ": cannot be read; check its permissions");
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  std::vector<char> block(kBlockBytes);
  while (in) {
    in.read(block.data(), std::streamsize(block.size()));
    XXH3_128bits_update(state.get(), block.data(), std::size_t(in.gcount()));
  }
  if (in.bad()) throw InputError(path.string() + ": reading failed");
  return hexadecimal(XXH3_128bits_digest(state.get()));
}

}  // namespace gonogo
