// Puts one self-contained HTML file together: the page in this folder, and the data that it shows.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/page/blob.h"

namespace gonogo::map {

/// The HTML of a page. `meta` becomes the constant of that name in data.js. Text in it is escaped, so it cannot end the
/// script or become markup.
std::string page_file(const Json& meta, const std::vector<Blob>& blobs);

/// JSON escaped for use inside a <script> element.
std::string script_safe(const Json& json);

}  // namespace gonogo::map
