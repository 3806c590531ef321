#include "terrain/raster/open_file.h"

#include <cpl_conv.h>
#include <cpl_minixml.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "terrain/raster/file/whole_file.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

/// Formats whose files hold their values themselves, by GDAL's names.
constexpr const char* kRasterFormats[] = {
    "VRT",      "GTiff",    "AAIGrid", "HFA",         "AIG",       "GRASSASCIIGrid",
    "SRTMHGT",  "USGSDEM",  "DTED",    "SDTS",        "GPKG",      "netCDF",
    "HDF5",     "HDF4",     "GRIB",    "BAG",         "ENVI",      "EHdr",
    "GenBin",   "XYZ",      "SAGA",    "GSAG",        "GSBG",      "GS7BG",
    "RST",      "ILWIS",    "PCIDSK",  "PCRaster",    "ERS",       "BT",
    "ACE2",     "NWT_GRD",  "NWT_GRC", "RMF",         "RRASTER",   "SIGDEM",
    "HF2",      "ZMap",     "GXF",     "LCP",         "GTX",       "BYN",
    "KRO",      "ISIS2",    "ISIS3",   "PDS",         "PDS4",      "VICAR",
    "FITS",     "SNODAS",   "NITF",    "ROI_PAC",     "ISCE",      "KEA",
    "Leveller", "Terragen", "JP2KAK",  "JP2OpenJPEG", "HDF5Image", "HDF4Image",
    "PNG",      "JPEG",     "BMP",     "GIF",         nullptr};
constexpr const char* kVectorFormats[] = {"ESRI Shapefile",
                                          "GPKG",
                                          "GeoJSON",
                                          "GeoJSONSeq",
                                          "FlatGeobuf",
                                          "GML",
                                          "KML",
                                          "LIBKML",
                                          "GPX",
                                          "DXF",
                                          "DGN",
                                          "CAD",
                                          "TopoJSON",
                                          "ESRIJSON",
                                          "OpenFileGDB",
                                          "MapInfo File",
                                          "S57",
                                          "OSM",
                                          "OGR_GMT",
                                          "EDIGEO",
                                          "SXF",
                                          "JML",
                                          "AVCE00",
                                          "AVCBin",
                                          "JSONFG",
                                          "Parquet",
                                          "Arrow",
                                          "VFK",
                                          "SOSI",
                                          "Idrisi",
                                          "UK .NTF",
                                          "TIGER",
                                          nullptr};

/// What maps are made with besides.
constexpr const char* kWorkFormats[] = {"MEM", "Memory", "COG", nullptr};

bool is_listed(const char* name) {
  for (const char* const* list : {kRasterFormats, kVectorFormats, kWorkFormats})
    for (; *list; ++list)
      if (EQUAL(*list, name)) return true;
  return false;
}

constexpr auto kNotice = std::chrono::seconds(10), kLongest = std::chrono::seconds(60);

const char* const* formats(FileKind kind) { return kind == FileKind::raster ? kRasterFormats : kVectorFormats; }

unsigned flags(FileKind kind) { return kind == FileKind::raster ? GDAL_OF_RASTER : GDAL_OF_VECTOR; }

const char* example(FileKind kind) { return kind == FileKind::raster ? "GeoTIFF" : "GeoPackage"; }

/// Name of the format among those of the list; null for others.
const char* format_on_list(const std::string& path, FileKind kind) {
  GDALDriverH driver = GDALIdentifyDriverEx(path.c_str(), flags(kind), formats(kind), nullptr);
  return driver ? GDALGetDriverShortName(driver) : nullptr;
}

bool is_file_or_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) || fs::is_directory(path, ignored);
}

[[noreturn]] void refuse_source(const fs::path& vrt, const std::string& source) {
  throw InputError(vrt.string() + ": names \"" + source.substr(0, 120) +
                   "\", which is no local file of a format that holds its values itself; give the rasters, or "
                   "--allow-network to follow such names");
}

/// A file in a local archive, as GDAL names it.
bool is_in_archive(const fs::path& path) {
  const std::string name = path.string();
  return name.rfind("/vsizip/", 0) == 0 || name.rfind("/vsitar/", 0) == 0 || name.rfind("/vsigzip/", 0) == 0;
}

/// Elements and keys of a virtual raster whose text names a file.
bool names_a_file(const std::string& word) {
  static constexpr std::array<const char*, 8> words = {"SourceFilename", "SourceDataset", "RPC_DEM",       "X_DATASET",
                                                       "Y_DATASET",      "OVERVIEW_FILE", "TargetDataset", "DataFile"};
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return EQUAL(w, word.c_str()); });
}

/// Labels and headers (PDS, ISIS, ERS) may name any file as theirs, here or elsewhere.
void check_folder(const fs::path& path, GDALDataset& dataset) {
  const CPLStringList files(dataset.GetFileList());
  std::error_code ec;
  const fs::path folder =
      fs::weakly_canonical(fs::is_directory(path, ec) ? path : fs::absolute(path).parent_path(), ec);
  for (int i = 0; i < files.size(); ++i) {
    if (is_in_archive(files[i])) continue;
    const fs::path within = fs::weakly_canonical(fs::absolute(files[i]).parent_path(), ec).lexically_relative(folder);
    if (within.empty() || *within.begin() == "..") refuse_source(path, files[i]);
  }
}

void check_virtual_raster(const fs::path& vrt, int depth);

void check_source(const fs::path& vrt, const CPLXMLNode& node, int depth) {
  const std::string name = CPLGetXMLValue(&node, "", "");
  if (name.empty()) return;
  const bool beside = std::string(CPLGetXMLValue(&node, "relativeToVRT", "0")) != "0";
  const fs::path file = beside ? vrt.parent_path() / name : fs::path(name);
  const char* format = is_file_or_folder(file) ? format_on_list(file.string(), FileKind::raster) : nullptr;
  if (!format) refuse_source(vrt, name);
  if (EQUAL(format, "VRT")) check_virtual_raster(file, depth + 1);
  if (EQUAL(format, "VRT") || EQUAL(format, "GTiff")) return;
  const DatasetHandle dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, kRasterFormats));
  if (dataset) check_folder(file, *dataset);
}

void check_nodes(const fs::path& vrt, const CPLXMLNode* node, int depth) {
  for (; node; node = node->psNext) {
    if (node->eType != CXT_Element) continue;
    const std::string key = CPLGetXMLValue(node, "key", CPLGetXMLValue(node, "name", ""));
    if (EQUAL(CPLGetXMLValue(node, "subClass", ""), "VRTRawRasterBand")) refuse_source(vrt, "VRTRawRasterBand");
    if (names_a_file(node->pszValue) || names_a_file(key)) check_source(vrt, *node, depth);
    check_nodes(vrt, node->psChild, depth);
  }
}

void check_virtual_raster(const fs::path& vrt, int depth) {
  constexpr int deepest = 8;
  if (depth > deepest) throw InputError(vrt.string() + ": virtual rasters name each other without an end");
  CPLXMLNode* tree = CPLParseXMLFile(vrt.c_str());
  const std::unique_ptr<CPLXMLNode, decltype(&CPLDestroyXMLNode)> owner(tree, &CPLDestroyXMLNode);
  check_nodes(vrt, tree, depth);
}

/// Files that belong to a Shapefile, which its .shp names.
bool is_beside_shapefile(const fs::path& file) {
  return EQUAL(file.extension().c_str(), ".dbf") || EQUAL(file.extension().c_str(), ".shx");
}

/// The one file of a format of the list that a .zip holds, as GDAL names it; the whole .zip where all of it is a
/// format, such as Shapefiles that lie in no folder.
std::string inside_zip(const fs::path& zip, FileKind kind) {
  const std::string root = "/vsizip/" + zip.string();
  const bool is_raster = kind == FileKind::raster;
  if (!is_raster && format_on_list(root, kind)) return root;
  const CPLStringList all(VSIReadDirRecursive(root.c_str()));
  std::vector<std::string> found;
  for (int i = 0; i < all.size(); ++i)
    if (std::string(all[i]).back() != '/' && (is_raster || !is_beside_shapefile(all[i])) &&
        format_on_list(root + "/" + all[i], kind))
      found.emplace_back(all[i]);
  if (found.size() == 1) return root + "/" + found.front();
  const std::string kind_name = is_raster ? "raster" : "file of lines or polygons";
  throw InputError(zip.string() + ": holds " +
                   (found.empty()
                        ? "no " + kind_name + "; unzip it and give the file that holds the values"
                        : "more than one " + kind_name + ", " + join_words(found) + "; unzip it and name the one"));
}

/// Drivers that are registered no more.
std::vector<GDALDriver*>& left_out_drivers() {
  static std::vector<GDALDriver*> list;
  return list;
}

/// The format of a file that no driver of the list takes; null for a file of none.
GDALDriver* other_format(const fs::path& path, FileKind kind) {
  if (format_on_list(path.string(), kind)) return nullptr;
  if (auto* driver = GDALDriver::FromHandle(GDALIdentifyDriverEx(path.c_str(), flags(kind), nullptr, nullptr)))
    return driver;
  const char* capability = kind == FileKind::raster ? GDAL_DCAP_RASTER : GDAL_DCAP_VECTOR;
  for (GDALDriver* driver : left_out_drivers()) {
    GDALOpenInfo info(path.c_str(), int(flags(kind)));
    if (driver->pfnIdentify && driver->GetMetadataItem(capability) && driver->pfnIdentify(&info) > 0) return driver;
  }
  return nullptr;
}

/// Why no format of the list takes the file.
[[noreturn]] void refuse_format(const fs::path& path, FileKind kind, const std::string& reason) {
  if (GDALDriver* other = other_format(path, kind))
    throw InputError(path.string() + ": is of the format " + other->GetDescription() + " (" +
                     other->GetMetadataItem(GDAL_DMD_LONGNAME) +
                     "), which may name hosts, databases or other files; give a " + example(kind) +
                     ", or --allow-network to open it");
  throw InputError(path.string() + ": cannot be read as " +
                   (kind == FileKind::raster ? "a raster" : "lines or polygons") + " (" + reason +
                   "); give a format that " + (kind == FileKind::raster ? "gdalinfo" : "ogrinfo") +
                   " opens, for example " + example(kind));
}

/// A sidecar (.aux.xml) may name a file of overviews, which GDAL opens by any driver.
void check_sidecar(const fs::path& path, GDALDataset& dataset) {
  const char* overviews = dataset.GetMetadataItem("OVERVIEW_FILE", "OVERVIEWS");
  if (overviews && !is_file_or_folder(overviews)) refuse_source(path, overviews);
}

/// What a thread that opens a file leaves behind.
struct Opening {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  DatasetHandle dataset;
  std::string reason;
};

/// From now on the program ends without GDAL's own end, which would wait for the thread that is left behind, for ever.
void end_without_waiting() {
  ::on_exit(
      [](int status, void*) {
        std::fflush(nullptr);
        ::_exit(status);
      },
      nullptr);
}

/// The thread of an opening: waited for once the file is open, left behind if it never opens. PROJ still holds locks
/// while such a thread ends, and a fork of this process would inherit them.
struct OpeningThread {
  std::thread running;
  bool opened = false;
  ~OpeningThread() {
    if (!opened) end_without_waiting();
    opened ? running.join() : running.detach();
  }
};

/// Opens in a thread of its own, so that a file system that does not answer can be left.
DatasetHandle open_in_time(const fs::path& path, const std::string& name, FileKind kind) {
  const auto opening = std::make_shared<Opening>();
  OpeningThread in_time{std::thread([opening, name, kind] {
    const GdalCall call;
    const char* const* list = network_allowed() ? nullptr : formats(kind);
    DatasetHandle dataset(GDALDataset::Open(name.c_str(), flags(kind) | GDAL_OF_READONLY, list));
    const std::lock_guard lock(opening->mutex);
    opening->reason = call.message();
    opening->dataset = std::move(dataset);
    opening->done = true;
    opening->changed.notify_all();
  })};
  const auto start = std::chrono::steady_clock::now();
  bool told = false;
  std::unique_lock lock(opening->mutex);
  while (!opening->changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return opening->done; })) {
    stop_if_cancelled();
    const auto waited = std::chrono::steady_clock::now() - start;
    if (waited > kLongest)
      throw InputError(
          path.string() +
          ": did not open within a minute; it is damaged or its disk does not answer, so fetch it again or copy it "
          "to a disk of this machine");
    if (waited > kNotice && !told) log_line(path.string(), "opening takes more than 10 s; Ctrl-C stops it");
    told = waited > kNotice;
  }
  in_time.opened = true;
  if (!opening->dataset) refuse_format(path, kind, opening->reason);
  return std::move(opening->dataset);
}

}  // namespace

void register_drivers() {
  static const bool registered = [] {
    GDALDriverManager& drivers = *GetGDALDriverManager();
    const bool is_ours = drivers.GetDriverCount() == 0 && !network_allowed();
    GDALAllRegister();
    for (int d = is_ours ? drivers.GetDriverCount() - 1 : -1; d >= 0; --d) {
      GDALDriver* driver = drivers.GetDriver(d);
      if (is_listed(driver->GetDescription())) continue;
      drivers.DeregisterDriver(driver);
      left_out_drivers().push_back(driver);
    }
    return true;
  }();
  (void)registered;
}

DatasetHandle open_file(const fs::path& path, FileKind kind) {
  const GdalCall call;
  std::error_code ec;
  if (!is_in_archive(path) && !(network_allowed() && path.string().rfind("/vsi", 0) == 0)) {
    if (!fs::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
    if (!is_file_or_folder(path)) throw InputError(path.string() + ": is neither a file nor a folder; give a file");
  }
  std::string name = path.string();
  if (EQUAL(path.extension().c_str(), ".zip")) name = inside_zip(path, kind);
  const char* format = network_allowed() ? nullptr : format_on_list(name, kind);
  if (format && EQUAL(format, "VRT")) check_virtual_raster(name, 0);
  const bool is_netcdf = EQUAL(path.extension().c_str(), ".nc") || (format && EQUAL(format, "netCDF"));
  if (is_netcdf && fs::is_regular_file(path, ec)) require_whole_netcdf(path);
  DatasetHandle dataset = open_in_time(path, name, kind);
  require_whole_raw(path, *dataset);
  require_whole_points(path, *dataset);
  if (network_allowed()) return dataset;
  check_sidecar(path, *dataset);
  if (!format || !EQUAL(format, "VRT")) check_folder(path, *dataset);
  return dataset;
}

}  // namespace gonogo::terrain
