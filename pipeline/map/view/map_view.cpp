#include "pipeline/map/view/map_view.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/json/json.h"

namespace gonogo::map {
namespace fs = std::filesystem;
namespace {

const HttpAnswer kNotFound = {404, "text/plain; charset=utf-8", "no such thing\n"};

std::string type_of(const std::string& name) {
  const std::string extension = fs::path(name).extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".json") return "application/json";
  if (extension == ".png") return "image/png";
  if (extension == ".tif") return "image/tiff";
  if (extension == ".csv") return "text/csv; charset=utf-8";
  if (extension == ".kml") return "application/vnd.google-earth.kml+xml";
  return "application/octet-stream";
}

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t from = 1; from <= path.size();) {
    const std::size_t to = std::min(path.find('/', from), path.size());
    parts.push_back(path.substr(from, to - from));
    from = to + 1;
  }
  return parts;
}

std::optional<int> whole_number(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

HttpAnswer json_answer(const Json& json) { return {200, "application/json", json.dump()}; }

}  // namespace

MapView::MapView(fs::path folder) : folder_(std::move(folder)) {
  if (!fs::exists(folder_ / "map.json"))
    throw InputError(folder_.string() + ": holds no map.json, so it is no finished map; make one with gonogo map");
  const Json record = Json::read(folder_ / "map.json");
  for (const auto& [name, hash] : record.at("files").members()) {
    files_.insert(name);
    if (fs::path(name).extension() == ".tif")
      layers_.emplace(fs::path(name).stem().string(), terrain::LayerReader(folder_ / name));
  }
}

HttpAnswer MapView::file(const std::string& name) const {
  if (files_.count(name) == 0) return kNotFound;
  return {200, type_of(name), read_file(folder_ / name)};
}

HttpAnswer MapView::layers() const {
  Json list = Json::object();
  for (const auto& [name, layer] : layers_) {
    Json entry = Json::object();
    entry["title"] = layer.title();
    entry["unit"] = layer.unit();
    entry["levels"] = layer.levels();
    list[name] = entry;
  }
  return json_answer(list);
}

HttpAnswer MapView::cell(int column, int row) const {
  Json values = Json::object();
  for (const auto& [name, layer] : layers_) {
    const auto value = layer.value(column, row);
    Json entry = Json::object();
    entry["title"] = layer.title();
    entry["unit"] = layer.unit();
    entry["value"] = value ? Json(*value) : Json();
    if (value) entry["label"] = layer.label(*value);
    values[name] = entry;
  }
  return json_answer(values);
}

HttpAnswer MapView::answer(const std::string& path) const {
  const std::vector<std::string> parts = parts_of(path);
  if (path == "/" || path == "/index.html") return file("index.html");
  if (parts.size() == 2 && parts[0] == "files") return file(parts[1]);
  if (path == "/view.json") return layers();
  if (parts.size() == 5 && parts[0] == "tile") {
    const auto layer = layers_.find(parts[1]);
    const auto level = whole_number(parts[2]), x = whole_number(parts[3]), y = whole_number(parts[4]);
    if (layer == layers_.end() || !level || !x || !y) return kNotFound;
    const auto png = layer->second.tile_png(*level, *x, *y);
    return png ? HttpAnswer{200, "image/png", *png} : kNotFound;
  }
  if (parts.size() == 3 && parts[0] == "cell") {
    const auto column = whole_number(parts[1]), row = whole_number(parts[2]);
    if (column && row) return cell(*column, *row);
  }
  return kNotFound;
}

}  // namespace gonogo::map
