#include "pipeline/map/page/page.h"

#include "base/error.h"
#include "pipeline/map/page/page_text.h"

namespace gonogo::map {

std::string script_safe(const Json& json) {
  std::string out;
  for (const char c : json.dump()) {
    if (c == '<')
      out += "\\u003c";
    else if (c == '>')
      out += "\\u003e";
    else if (c == '&')
      out += "\\u0026";
    else
      out += c;
  }
  return out;
}

std::string page_file(const Json& meta, const std::vector<Blob>& blobs) {
  std::string elements;
  for (const Blob& blob : blobs) elements += blob_element(blob);
  const std::pair<const char*, std::string> parts[] = {
      {"{{css}}", page_css()}, {"{{meta}}", script_safe(meta)}, {"{{blobs}}", elements}, {"{{js}}", page_js()}};
  const std::string& html = page_html();
  std::string out;
  std::size_t from = 0;
  for (const auto& [mark, text] : parts) {  // in the order in which they stand in the file
    const std::size_t at = html.find(mark, from);
    GONOGO_ASSERT(at != std::string::npos);
    out += html.substr(from, at - from) + text;
    from = at + std::string(mark).size();
  }
  return out + html.substr(from);
}

}  // namespace gonogo::map
