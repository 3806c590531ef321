// DEFLATE by GDAL, which takes libdeflate where it has that.
#pragma once
#include <cstddef>
#include <string>

namespace gonogo::terrain {

/// In the format of zlib (RFC 1950). level: 1, the fastest, to 9. Throws DeviceError when memory runs out.
std::string deflated(const void* bytes, std::size_t size, int level);

}  // namespace gonogo::terrain
