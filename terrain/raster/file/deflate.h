// DEFLATE by GDAL, which takes libdeflate where it has that.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace gonogo::terrain {

/// In the format of zlib (RFC 1950). level: 1, the fastest, to 9. Throws DeviceError when memory runs out.
std::string deflated(const void* bytes, std::size_t size, int level);

/// The reverse. Returns whether the bytes are such, and of `size` before.
bool inflate(std::string_view bytes, void* out, std::size_t size);

}  // namespace gonogo::terrain
