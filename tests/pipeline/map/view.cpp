// A map served to a browser: what is asked for comes as it stands in the files, and nothing else does.
#include "pipeline/map/map_view.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/json.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

constexpr int kSide = 700;

void make_small_map(const TemporaryFolder& folder) {
  test::make_wavy_region(folder, "waves", {kSide, 40, 17, 23});
  make_map(test::request_of_region(folder, "map"));
}

/// What the server answers to `request`, header and body.
std::string ask(std::uint16_t port, const std::string& request) {
  const int connection = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(connection, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0);
  REQUIRE(::send(connection, request.data(), request.size(), MSG_NOSIGNAL) == ssize_t(request.size()));
  std::string answer;
  char part[4096];
  for (ssize_t got = 0; (got = ::recv(connection, part, sizeof part, 0)) > 0;) answer.append(part, std::size_t(got));
  ::close(connection);
  return answer;
}

std::string get(std::uint16_t port, const std::string& path, const std::string& host = "127.0.0.1") {
  return ask(port, "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
}

std::string status(const std::string& answer) { return answer.substr(0, 12); }
std::string body(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

}  // namespace

TEST_CASE("a served map gives its files, tiles and cells, and nothing outside its folder") {
  const TemporaryFolder folder;
  make_small_map(folder);
  write_file_atomically(folder / "secret.txt", "secret");
  write_file_atomically(folder / "map/unlisted.txt", "unlisted");
  const MapView view(folder / "map");
  HttpServer server("127.0.0.1", 0);
  std::thread serving([&] { server.run([&](const std::string& path) { return view.answer(path); }); });
  const std::uint16_t port = server.port();

  CHECK(body(get(port, "/")) == read_file(folder / "map/index.html"));
  CHECK(body(get(port, "/files/area.csv")) == read_file(folder / "map/area.csv"));
  CHECK(body(get(port, "/files/go.tif?x=1")) == read_file(folder / "map/go.tif"));
  for (const char* path : {"/files/../secret.txt", "/files/%2e%2e%2fsecret.txt", "/files/unlisted.txt", "/secret.txt",
                           "//etc/passwd", "/files/", "/tile/go/9/0/0", "/tile/go/0/99/0", "/tile/go/0/-1/0",
                           "/tile/nothing/0/0/0", "/tile/go/x/0/0", "/cell/1", "/cell/1/b"})
    CHECK(status(get(port, path)) == "HTTP/1.1 404");
  CHECK(status(ask(port, "POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")) == "HTTP/1.1 405");
  CHECK(status(ask(port, "nonsense\r\n\r\n")) == "HTTP/1.1 400");
  CHECK(status(get(port, "/", "evil.example:80")) == "HTTP/1.1 403");
  CHECK(status(get(port, "/", "localhost:1234")) == "HTTP/1.1 200");
  CHECK(body(ask(port, "HEAD / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")).empty());

  const auto grid = terrain::RasterSource::open_elevation(folder / "map/go.tif").grid();
  const auto p = terrain::RasterSource::open_on_grid(folder / "map/p_go.tif", grid, terrain::RasterKind::classes);
  const Json cell = Json::parse(body(get(port, "/cell/333/222")), "cell");
  CHECK(cell.at("p_go").at("value").number() == Approx(p.read({333, 222, 1, 1}).at(0, 0)));
  CHECK_FALSE(cell.at("go").at("label").string().empty());
  CHECK(Json::parse(body(get(port, "/cell/0/0")), "border").at("go").at("value").is_null());

  const std::string png = body(get(port, "/tile/go/0/1/1"));
  std::vector<unsigned char> bytes(png.begin(), png.end());
  VSIFCloseL(VSIFileFromMemBuffer("/vsimem/t.png", bytes.data(), bytes.size(), FALSE));
  GDALDataset* picture = GDALDataset::Open("/vsimem/t.png");
  REQUIRE(picture);
  CHECK(picture->GetRasterXSize() == kSide - 512);
  const auto go = terrain::RasterSource::open_elevation(folder / "map/go.tif").read({512, 512, 188, 188});
  std::vector<unsigned char> red(188 * 188), opacity(188 * 188);
  REQUIRE(picture->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 188, 188, red.data(), 188, 188, GDT_Byte, 0, 0, nullptr) ==
          CE_None);
  REQUIRE(picture->GetRasterBand(4)->RasterIO(GF_Read, 0, 0, 188, 188, opacity.data(), 188, 188, GDT_Byte, 0, 0,
                                              nullptr) == CE_None);
  GDALClose(picture);
  for (std::size_t i = 0; i < red.size(); ++i) {
    REQUIRE((opacity[i] == 0) == std::isnan(go.value[i]));
    if (go.value[i] == int(Verdict::go)) REQUIRE(red[i] == 0x1a);
    if (go.value[i] == int(Verdict::no_go)) REQUIRE(red[i] == 0xd7);
  }
  server.stop();
  serving.join();
}

TEST_CASE("a folder without a whole map, and an address that is none, are refused") {
  const TemporaryFolder folder;
  CHECK(contains(input_error([&] { MapView(folder.path()); }), "holds no map.json"));
  CHECK(contains(input_error([] { HttpServer("localhost:80", 0); }), "no IPv4 address"));
  CHECK(decoded_path("/a%20b?c#d") == "/a b");
  CHECK(decoded_path("/%zz%2") == "/%zz%2");
}
