#include "pipeline/map/view/http.h"

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

#include "base/cancel.h"
#include "base/error.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kMaxRequest = 16384;
constexpr int kLookMs = 200;  // how often the server looks whether it should stop

const char* reason_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    default:
      return "Internal Server Error";
  }
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

}  // namespace gonogo::map
