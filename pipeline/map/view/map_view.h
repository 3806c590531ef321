// Serves a map folder to a browser: the page, its files, and tiles and cell values read from the GeoTIFFs on demand.
//
//   /                              index.html
//   /files/<name>                  a file that map.json lists
//   /view.json                     layers: name, title, unit, levels
//   /tile/<layer>/<level>/<x>/<y>  512-cell tile as PNG, level 0 the map
//   /cell/<column>/<row>           every layer's value there
#pragma once
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "pipeline/map/view/http.h"
#include "terrain/raster/layer_reader.h"

namespace gonogo::map {

class MapView {
 public:
  /// Throws InputError if the folder holds no finished map.
  explicit MapView(std::filesystem::path folder);
  /// Answers one path of the list above; anything else is status 404. Only files listed in map.json can be read.
  HttpAnswer answer(const std::string& path) const;

 private:
  HttpAnswer file(const std::string& name) const;
  HttpAnswer layers() const;
  HttpAnswer cell(int column, int row) const;

  std::filesystem::path folder_;
  std::set<std::string> files_;
  std::map<std::string, terrain::LayerReader> layers_;
};

}  // namespace gonogo::map
