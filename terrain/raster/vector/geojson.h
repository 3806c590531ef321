// What GDAL's reader of GeoJSON leaves out without a word.
#pragma once
#include <cstdint>
#include <string>

namespace gonogo::terrain {

/// Number of features of a GeoJSON text that state a shape: "geometry" with coordinates or members, whatever they are
/// worth. GDAL hands on a feature without a shape where these are misspelt, no numbers or too few. `by_lines`: a
/// feature a line. Throws InputError that begins with `name` for text that is no JSON.
std::uint64_t stated_shapes(const std::string& text, bool by_lines, const std::string& name);

}  // namespace gonogo::terrain
