// A minimal HTTP/1.1 server (RFC 9110, 9112) that shows a map to a browser on the same machine.
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

}  // namespace gonogo::map
