// Just enough of HTTP/1.1 (RFC 9110, 9112) to show files and answers to a browser on the same machine.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace gonogo::map {

struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8", body;
};

class HttpServer {
 public:
  /// Listens on `address` (an IPv4 address) and `port`, 0 for any free one. Throws DeviceError when that is refused,
  /// InputError for what is no address.
  HttpServer(const std::string& address, std::uint16_t port);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  std::uint16_t port() const { return port_; }
  /// Answers GET and HEAD by `answer(path)`, path without query and with %xx decoded, one request after the other,
  /// until cancel_requested() or stop(). Exceptions of `answer` become status 500. Requests whose Host is neither the
  /// address nor localhost are refused, so that no page of another site can read the map by a name of its own.
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

/// %xx decoded; nothing but the path: query and fragment are cut off.
std::string decoded_path(const std::string& target);

}  // namespace gonogo::map
