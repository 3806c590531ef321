// Arrays as a page stores them: filtered, deflated, base64.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace gonogo::map {

/// How a value is predicted from its neighbours in the row-by-row array. Only the difference is stored. The prediction
/// is 0, left, left + up - corner or (left + up) / 2. blob_element() takes the filter that deflates best.
enum class BlobFilter { none = 0, left = 1, plane = 2, mean = 3 };

struct Blob {
  std::string name;
  int bits = 8;                      // per value: 8 or 16
  std::size_t width = 1;             // values per row
  std::vector<std::uint16_t> value;  // below 2^bits
};

/// Difference of every value from its prediction, modulo 2^bits [same size].
std::vector<std::uint16_t> filtered(const Blob& blob, BlobFilter filter);
/// The blob as <script type="application/x-gonogo" ...>base64</script>. data.js reads it.
std::string blob_element(const Blob& blob);
std::string base64(const std::string& bytes);

}  // namespace gonogo::map
