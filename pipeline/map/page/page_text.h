// The parts of the page as they stand in this folder; {{css}}, {{js}}, {{meta}} and {{blobs}} in the HTML are filled
// in.
#pragma once
#include <string>

namespace gonogo::map {

const std::string& page_html();
const std::string& page_css();
const std::string& page_js();

}  // namespace gonogo::map
