// The sources of the page as compiled into the program. page_file() fills {{css}}, {{js}}, {{meta}} and {{blobs}} in.
#pragma once
#include <string>

namespace gonogo::map {

const std::string& page_html();
const std::string& page_css();
const std::string& page_js();

}  // namespace gonogo::map
