// One self-contained HTML file: the page of this folder with what it shows.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/page/blob.h"

namespace gonogo::map {

/// `meta` is what data.js calls meta. Any text in it is shown as text: nothing of it can end the script or become
/// markup.
std::string page_file(const Json& meta, const std::vector<Blob>& blobs);

/// JSON that can stand inside a <script> element.
std::string script_safe(const Json& json);

}  // namespace gonogo::map
