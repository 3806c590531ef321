// Shows a map folder to a browser on this machine.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "terrain/raster/layer/layer_picture.h"

namespace gonogo::map {

/// A minimal HTTP/1.1 server (RFC 9110, 9112) that shows a map to a browser on the same machine.
struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body;
};

class HttpServer {
 public:
  /// Listens on an IPv4 `address` and `port`; port 0 takes any free one. Throws InputError for a text that is no
  /// address and DeviceError if the system refuses to listen.
  HttpServer(const std::string& address, std::uint16_t port);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  std::uint16_t port() const { return port_; }
  /// Answers GET and HEAD requests by `answer(path)`, one after the other, until cancel_requested() or stop(). `path`
  /// has no query and %xx is decoded. Exceptions of `answer` become status 500. The request's Host must be the address
  /// or localhost. Otherwise a page of another site could read the map through a host name of its own (DNS rebinding).
  void run(const std::function<HttpAnswer(const std::string& path)>& answer);
  void stop() { stopped_ = true; }

 private:
  void serve(int connection, const std::function<HttpAnswer(const std::string&)>& answer) const;
  bool is_own_host(const std::string& host) const;

  std::string address_;
  std::uint16_t port_ = 0;
  int socket_ = -1;
  std::atomic<bool> stopped_ = false;
};

/// The path of a request target: %xx decoded, query and fragment cut off.
std::string decoded_path(const std::string& target);

/// Serves a map folder to a browser: the page, its files, and tiles and cell values read from the GeoTIFFs on demand.
///
///   /                              index.html
///   /files/<name>                  a file that map.json lists
///   /view.json                     layers: name, title, unit, levels
///   /tile/<layer>/<level>/<x>/<y>  512-cell tile as PNG, level 0 the map
///   /cell/<column>/<row>           every layer's value there
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
