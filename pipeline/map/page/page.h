// Puts one self-contained HTML file together: the page in this folder, and the data that it shows.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::map {

/// How a value is predicted from its neighbours in the row-by-row array. Only the difference is stored. The prediction
/// is 0, left, left + up - corner or (left + up) / 2. blob_element() takes the filter that deflates best at the fastest
/// level.
enum class BlobFilter { none = 0, left = 1, plane = 2, mean = 3 };

/// An array as the page stores it: filtered, deflated, base64.
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

/// The HTML of a page. `meta` becomes the constant of that name in data.js. Text in it is escaped, so it cannot end the
/// script or become markup.
std::string page_file(const Json& meta, const std::vector<Blob>& blobs);

/// JSON escaped for use inside a <script> element.
std::string script_safe(const Json& json);

/// The sources of the page as compiled into the program. page_file() fills {{css}}, {{js}}, {{meta}} and {{blobs}} in.
const std::string& page_html();
const std::string& page_css();
const std::string& page_js();

}  // namespace gonogo::map
