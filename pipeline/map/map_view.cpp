#include "pipeline/map/map_view.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/json.h"
#include "base/progress.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

namespace {

constexpr std::size_t kMaxRequest = 16384;
constexpr int kLookMs = 200;  // how often the server looks whether it should stop

const char* reason_of(int status) {
  static const std::map<int, const char*> reasons = {
      {200, "OK"}, {400, "Bad Request"}, {403, "Forbidden"}, {404, "Not Found"}, {405, "Method Not Allowed"}};
  const auto found = reasons.find(status);
  return found == reasons.end() ? "Internal Server Error" : found->second;
}

/// Up to the empty line after the headers; "" when the other side sends none in time.
std::string read_request(int connection) {
  std::string text;
  char part[4096];
  while (text.find("\r\n\r\n") == std::string::npos && text.size() < kMaxRequest) {
    const ssize_t got = ::recv(connection, part, sizeof part, 0);
    if (got <= 0) return "";
    text.append(part, std::size_t(got));
  }
  return text;
}

void send_all(int connection, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t put = ::send(connection, text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (put <= 0) return;  // the browser went away
    done += std::size_t(put);
  }
}

std::string header(const std::string& request, const std::string& name) {
  for (std::size_t at = request.find("\r\n"); at != std::string::npos; at = request.find("\r\n", at + 2)) {
    const std::size_t colon = request.find(':', at + 2);
    if (colon == std::string::npos || colon - at - 2 != name.size()) continue;
    if (!std::equal(name.begin(), name.end(), request.begin() + std::ptrdiff_t(at) + 2,
                    [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); }))
      continue;
    std::string value = request.substr(colon + 1, request.find("\r\n", colon) - colon - 1);
    value.erase(0, value.find_first_not_of(" \t"));
    return value.substr(0, value.find_last_not_of(" \t") + 1);
  }
  return "";
}

}  // namespace

std::string decoded_path(const std::string& target) {
  const std::string path = target.substr(0, target.find_first_of("?#"));
  std::string out;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '%' && i + 2 < path.size() && std::isxdigit(static_cast<unsigned char>(path[i + 1])) &&
        std::isxdigit(static_cast<unsigned char>(path[i + 2]))) {
      out += char(std::stoi(path.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      out += path[i];
    }
  }
  return out;
}

HttpServer::HttpServer(const std::string& address, std::uint16_t port) : address_(address) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &place.sin_addr) != 1)
    throw InputError("view: --address \"" + address + "\" is no IPv4 address; use for example 127.0.0.1");
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (socket_ >= 0) ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
      ::listen(socket_, 32) != 0) {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) ::close(socket_);
    throw DeviceError("view: cannot listen on " + address + ":" + std::to_string(port) + ": " + why);
  }
  socklen_t size = sizeof place;
  ::getsockname(socket_, reinterpret_cast<sockaddr*>(&place), &size);
  port_ = ntohs(place.sin_port);
}

HttpServer::~HttpServer() { ::close(socket_); }

bool HttpServer::is_own_host(const std::string& host) const {
  if (address_ == "0.0.0.0") return true;  // asked for by name: whoever reaches the machine
  const std::string name = host.substr(0, host.rfind(':'));
  return name == address_ || name == "localhost" || (address_.rfind("127.", 0) == 0 && name == "127.0.0.1");
}

void HttpServer::serve(int connection, const std::function<HttpAnswer(const std::string&)>& answer) const {
  const std::string request = read_request(connection);
  if (request.empty()) return;
  const std::size_t first = request.find(' '), second = request.find(' ', first + 1);
  const std::string method = request.substr(0, first);
  HttpAnswer out;
  if (first == std::string::npos || second == std::string::npos || second > request.find("\r\n"))
    out = {400, "text/plain; charset=utf-8", "no request\n"};
  else if (method != "GET" && method != "HEAD")
    out = {405, "text/plain; charset=utf-8", "only GET and HEAD\n"};
  else if (!is_own_host(header(request, "Host")))
    out = {403, "text/plain; charset=utf-8", "asked for under another name\n"};
  else
    try {
      out = answer(decoded_path(request.substr(first + 1, second - first - 1)));
    } catch (const std::exception& e) {
      out = {500, "text/plain; charset=utf-8", std::string(e.what()) + "\n"};
    }
  const std::string head =
      "HTTP/1.1 " + std::to_string(out.status) + " " + reason_of(out.status) + "\r\nContent-Type: " + out.type +
      "\r\nContent-Length: " + std::to_string(out.body.size()) +
      "\r\nX-Content-Type-Options: nosniff\r\nCache-Control: no-cache\r\nConnection: close\r\n\r\n";
  send_all(connection, method == "HEAD" ? head : head + out.body);
}

void HttpServer::run(const std::function<HttpAnswer(const std::string&)>& answer) {
  while (!stopped_ && !cancel_requested()) {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, kLookMs) <= 0) continue;
    const int connection = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) continue;
    const timeval patience{2, 0};  // a connection that a browser opens in advance must not hold up the others
    ::setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(connection, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    serve(connection, answer);
    ::close(connection);
  }
}

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

HttpAnswer json_answer(const Json& json) { return {200, "application/json", json.dump()}; }

}  // namespace

MapView::MapView(fs::path folder) : folder_(std::move(folder)) {
  if (!fs::exists(folder_ / "map.json"))
    throw InputError(folder_.string() + ": holds no map.json, so it is no finished map; make one with gonogo map");
  const Json record = Json::read(folder_ / "map.json");
  for (const auto& [name, hash] : record.at("files").members()) {
    require_whole_map(folder_, {name});
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
    list[name] = Json::Object{{"title", layer.title()}, {"unit", layer.unit()}, {"levels", layer.levels()}};
  }
  return json_answer(list);
}

HttpAnswer MapView::cell(int column, int row) const {
  Json values = Json::object();
  for (const auto& [name, layer] : layers_) {
    const auto value = layer.value(column, row);
    Json entry =
        Json::Object{{"title", layer.title()}, {"unit", layer.unit()}, {"value", value ? Json(*value) : Json()}};
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
    const auto level = parsed<int>(parts[2]), x = parsed<int>(parts[3]), y = parsed<int>(parts[4]);
    if (layer == layers_.end() || !level || !x || !y) return kNotFound;
    const auto png = layer->second.tile_png(*level, *x, *y);
    return png ? HttpAnswer{200, "image/png", *png} : kNotFound;
  }
  if (parts.size() == 3 && parts[0] == "cell") {
    const auto column = parsed<int>(parts[1]), row = parsed<int>(parts[2]);
    if (column && row) return cell(*column, *row);
  }
  return kNotFound;
}

}  // namespace gonogo::map
