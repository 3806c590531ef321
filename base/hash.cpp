#include "base/hash.h"

#define XXH_INLINE_ALL  // header-only: no library to link
#include <xxhash.h>

#include <cstdio>

#include "base/file.h"

namespace gonogo {

std::string content_hash(std::string_view content) {
  const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

std::string file_hash(const std::filesystem::path& path) { return content_hash(read_file(path)); }

}  // namespace gonogo
