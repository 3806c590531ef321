// Arrays as a page holds them: filtered, deflated, in base64.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace gonogo::map {

/// Differences from what the neighbours in a row-by-row array say; the filter that deflates best is taken.
enum class BlobFilter { none = 0, left = 1, plane = 2, mean = 3 };  // 0, left, left + up - corner, (left + up) / 2

struct Blob {
  std::string name;
  int bits = 8;                      // of a value: 8 or 16
  std::size_t width = 1;             // values in a row
  std::vector<std::uint16_t> value;  // below 2^bits
};

/// value - expected, modulo 2^bits.
std::vector<std::uint16_t> filtered(const Blob& blob, BlobFilter filter);
/// <script type="application/x-gonogo" ...>base64</script>
std::string blob_element(const Blob& blob);
std::string base64(const std::string& bytes);

}  // namespace gonogo::map
