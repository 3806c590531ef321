#include "terrain/raster/file/deflate.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <memory>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

struct FreeGdal {
  void operator()(void* memory) const { VSIFree(memory); }
};

}  // namespace

std::string deflated(const void* bytes, std::size_t size, int level) {
  std::size_t packed_size = 0;
  const std::unique_ptr<void, FreeGdal> packed(CPLZLibDeflate(bytes, size, level, nullptr, 0, &packed_size));
  if (!packed) throw DeviceError("CPLZLibDeflate: bytes cannot be compressed, out of memory");
  return {static_cast<const char*>(packed.get()), packed_size};
}

bool inflate(std::string_view bytes, void* out, std::size_t size) {
  std::size_t found = 0;
  return CPLZLibInflate(bytes.data(), bytes.size(), out, size, &found) && found == size;
}

}  // namespace gonogo::terrain
