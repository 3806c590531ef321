// Local files that name a host, a database or bytes of other files, in every way that a format of GDAL offers. The
// program's own drivers are registered here by its readers alone, as in the program: no request may arrive.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::terrain;
namespace fs = std::filesystem;

namespace {

/// A socket of this machine that counts who calls.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(listen(socket_, 64) == 0);
    socklen_t size = sizeof address;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(socket_); }
  std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  int port() const { return port_; }
  bool was_called() const { return accept(socket_, nullptr, nullptr) >= 0; }

 private:
  int socket_, port_ = 0;
};

const std::string kHead =
    R"(<VRTDataset rasterXSize="8" rasterYSize="6"><SRS>EPSG:32610</SRS>)"
    R"(<GeoTransform>500000,10,0,4400000,0,-10</GeoTransform><VRTRasterBand dataType="Float32" band="1")";
const std::string kTail = "</VRTRasterBand></VRTDataset>";

std::string vrt_of(const std::string& source) {
  return kHead + "><SimpleSource><SourceFilename>" + source + "</SourceFilename></SimpleSource>" + kTail;
}

std::string ers_of(const std::string& data) {
  return "DatasetHeader Begin\n Version = \"6.0\"\n DataFile = \"" + data +
         "\"\n DataType = Raster\n ByteOrder = LSBFirst\n RasterInfo Begin\n  CellType = IEEE4ByteReal\n  NrOfLines = "
         "6\n  "
         "NrOfCellsPerLine = 8\n  NrOfBands = 1\n RasterInfo End\nDatasetHeader End\n";
}

std::string pds_of(const std::string& image) {
  return "PDS_VERSION_ID = PDS3\r\n^IMAGE = \"" + image +
         "\"\r\nRECORD_BYTES = 32\r\nOBJECT = IMAGE\r\n LINES = 6\r\n LINE_SAMPLES = 8\r\n SAMPLE_TYPE = PC_REAL\r\n "
         "SAMPLE_BITS = 32\r\nEND_OBJECT = IMAGE\r\nEND\r\n";
}

std::string isis_of(const std::string& core) {
  return "Object = IsisCube\n  Object = Core\n    StartByte = 1\n    ^Core = " + core +
         "\n    Format = BandSequential\n    Group = Dimensions\n      Samples = 8\n      Lines = 6\n      Bands = 1\n "
         "   "
         "End_Group\n    Group = Pixels\n      Type = Real\n      ByteOrder = Lsb\n      Base = 0.0\n      Multiplier "
         "= "
         "1.0\n    End_Group\n  End_Object\nEnd_Object\nEnd\n";
}

std::string wms_of(const std::string& host) {
  return "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://" + host +
         "/${z}/${x}/${y}.png</ServerUrl></Service><DataWindow><UpperLeftX>500000</UpperLeftX><UpperLeftY>4400000"
         "</UpperLeftY><LowerRightX>500080</LowerRightX><LowerRightY>4399940</LowerRightY><SizeX>8</SizeX><SizeY>6</"
         "SizeY>"
         "</DataWindow><Projection>EPSG:32610</Projection><BandsCount>1</BandsCount></GDAL_WMS>";
}

/// 8 x 6 cells of 10 m in UTM zone 10, by text alone.
void write_grid(const TemporaryFolder& folder, const std::string& name) {
  std::string text = "ncols 8\nnrows 6\nxllcorner 500000\nyllcorner 4399940\ncellsize 10\nNODATA_value -9999\n";
  for (int row = 0; row < 6; ++row) text += "101.5 102 103 104 105 106 107 108\n";
  write_file_atomically(folder / (name + ".asc"), text);
  write_file_atomically(folder / (name + ".prj"),
                        R"(PROJCS["WGS 84 / UTM zone 10N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,)"
                        R"(298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
                        R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
                        R"(PARAMETER["central_meridian",-123],PARAMETER["scale_factor",0.9996],)"
                        R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])");
}

std::string sentence_of_raster(const fs::path& file) {
  return input_error([&] {
    const RasterSource source = RasterSource::open_heights(file, {}, {});
    source.read({0, 0, source.grid().columns, source.grid().rows});
  });
}

}  // namespace

TEST_CASE("no raster that names a host, a database or another file's bytes sends a request or is taken") {
  const TemporaryFolder folder;
  const Listener listener;
  const std::string url = "http://" + listener.host() + "/a.tif";
  const std::string pg =
      "PG:host=127.0.0.1 port=" + std::to_string(listener.port()) + " dbname=a connect_timeout=2 mode=2";
  write_grid(folder, "plain");
  CHECK(sentence_of_raster(folder / "plain.asc").empty());
  write_file_atomically(folder / "secret.bin", std::string(4000, 'x'));
  const std::string secret = folder / "secret.bin";
  const auto put = [&](const std::string& name, const std::string& text) {
    write_file_atomically(folder / name, text);
  };
  put("url.vrt", vrt_of("/vsicurl/" + url));
  put("streaming.vrt", vrt_of("/vsicurl_streaming/" + url));
  put("cloud.vrt", vrt_of("/vsis3/bucket/a.tif"));
  put("database.vrt", vrt_of(pg));
  put("wms.vrt", vrt_of("WMS:" + url));
  put("inline.vrt", vrt_of("&lt;GDAL_WMS&gt;&lt;/GDAL_WMS&gt;"));
  put("nested.vrt", vrt_of("url.vrt"));
  put("raw.vrt", kHead + " subClass=\"VRTRawRasterBand\"><SourceFilename>" + secret + "</SourceFilename>" + kTail);
  put("wms.tif", wms_of(listener.host()));
  put("wms.xml", wms_of(listener.host()));
  put("to_wms.vrt", vrt_of("wms.xml"));
  put("to_url.ers", ers_of("/vsicurl/" + url));
  put("to_wms.ers", ers_of((folder / "wms.xml").string()));
  put("to_vrt.ers", ers_of((folder / "raw.vrt").string()));
  put("to_database.ers", ers_of(pg));
  put("to_passwd.ers", ers_of("/etc/passwd"));
  fs::create_directory(folder / "sources");
  put("sources/to_passwd.ers", ers_of("/etc/passwd"));
  put("to_label.vrt", vrt_of((folder / "sources/to_passwd.ers").string()));
  put("to_url.lbl", pds_of("/vsicurl/" + url));
  put("to_passwd.lbl", pds_of("/etc/passwd"));
  put("to_url.cub", isis_of("/vsicurl/" + url));
  put("to_passwd.cub", isis_of("/etc/passwd"));
  put("wcs.xml", "<WCS_GDAL><ServiceURL>http://" + listener.host() +
                     "/wcs?</ServiceURL><CoverageName>a</CoverageName></WCS_GDAL>");
  put("tile.json", R"({"tiles": ["http://)" + listener.host() + R"(/{z}/{x}/{y}.png"], "minzoom": 0, "maxzoom": 1})");
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    const std::string kind = entry.path().extension();
    if (kind == ".bin" || kind == ".asc" || kind == ".prj" || entry.is_directory()) continue;
    INFO(entry.path());
    const auto start = std::chrono::steady_clock::now();
    const std::string sentence = sentence_of_raster(entry.path());
    CHECK_FALSE(sentence.empty());
    CHECK_FALSE(contains(sentence, "\n"));
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
    CHECK_FALSE(listener.was_called());
  }
}

TEST_CASE("what lies beside a raster calls nobody") {
  const TemporaryFolder folder;
  const Listener listener;
  write_grid(folder, "a");
  write_file_atomically(folder / "a.asc.aux.xml",
                        "<PAMDataset><Metadata domain=\"OVERVIEWS\"><MDI key=\"OVERVIEW_FILE\">/vsicurl/http://" +
                            listener.host() + "/a.ovr</MDI></Metadata></PAMDataset>");
  CHECK(contains(sentence_of_raster(folder / "a.asc"), "--allow-network"));
  CHECK_FALSE(listener.was_called());
}

TEST_CASE("no vector file that names a host or a database sends a request") {
  const TemporaryFolder folder;
  const Listener listener;
  write_grid(folder, "grid");
  const MapGrid grid = RasterSource::open_as_it_lies(folder / "grid.asc").grid();
  const std::string host = "http://" + listener.host();
  const std::string square = "-123.0000,39.7490 -122.9995,39.7490 -122.9995,39.7485 -123.0000,39.7490";
  const auto put = [&](const std::string& name, const std::string& text) {
    write_file_atomically(folder / name, text);
  };
  put("link.geojson",
      R"({"type":"FeatureCollection","crs":{"type":"link","properties":{"href":")" + host +
          R"(/crs"}},"features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon",)"
          R"("coordinates":[[[500001,4399999],[500009,4399999],[500009,4399991],[500001,4399999]]]}}]})");
  put("wfs.xml", "<OGRWFSDataSource><URL>" + host + "/wfs</URL></OGRWFSDataSource>");
  put("url.vrt", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>/vsicurl/" + host +
                     "/a.geojson</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
  put("database.vrt", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>PG:host=127.0.0.1 port=" +
                          std::to_string(listener.port()) + "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
  put("link.kml", R"(<?xml version="1.0"?><!DOCTYPE kml SYSTEM ")" + host +
                      R"(/kml.dtd"><kml xmlns="http://www.opengis.net/kml/2.2"><Document><NetworkLink><Link><href>)" +
                      host + "/a.kml</href></Link></NetworkLink><Style id=\"s\"><IconStyle><Icon><href>" + host +
                      "/a.png</href></Icon></IconStyle></Style><Placemark><styleUrl>" + host +
                      "/s.kml#s</styleUrl><Polygon><outerBoundaryIs><LinearRing><coordinates>" + square +
                      "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>");
  put("schema.gml",
      R"(<?xml version="1.0"?><!DOCTYPE a [<!ENTITY e SYSTEM ")" + host +
          R"(/entity">]><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/" )"
          R"(xmlns:gml="http://www.opengis.net/gml" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" )"
          R"(xmlns:xlink="http://www.w3.org/1999/xlink" xsi:schemaLocation="http://ogr.maptools.org/ )" +
          host + R"(/a.xsd"><gml:featureMember><ogr:a><ogr:geometryProperty xlink:href=")" + host +
          R"(/g.gml#g"/><ogr:name>&e;</ogr:name></ogr:a></gml:featureMember></ogr:FeatureCollection>)");
  put("gpx.gpx",
      R"(<?xml version="1.0"?><!DOCTYPE gpx SYSTEM ")" + host +
          R"(/gpx.dtd"><gpx version="1.1"><trk><trkseg><trkpt lat="39.7" lon="-123"/></trkseg></trk></gpx>)");
  put("service.json", R"({"currentVersion":10.1,"serviceDescription":"","layers":[],"url":")" + host + R"("})");
  for (const auto& entry : fs::directory_iterator(folder.path())) {
    const std::string kind = entry.path().extension();
    if (kind == ".asc" || kind == ".prj") continue;
    INFO(entry.path());
    const auto start = std::chrono::steady_clock::now();
    const std::string sentence = input_error([&] { cells_under(entry.path(), grid); });
    CHECK_FALSE(contains(sentence, "\n"));
    if (kind != ".kml") CHECK_FALSE(sentence.empty());
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
    CHECK_FALSE(listener.was_called());
  }
}
