#include "terrain/raster/file/whole_file.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

/// A header that ends early, or whose numbers cannot be.
struct Damaged {};

/// Reads the header in the order of its grammar (NetCDF Users Guide, appendix "File Format Specifications", classic
/// format): numbers are big-endian, names and values are padded to four bytes.
class Header {
 public:
  explicit Header(std::istream& in) : in_(in) {
    std::array<char, 4> magic{};
    read(magic.data(), 4);
    version_ = magic[3];
    is_classic_ =
        magic[0] == 'C' && magic[1] == 'D' && magic[2] == 'F' && (version_ == 1 || version_ == 2 || version_ == 5);
  }
  bool is_classic() const { return is_classic_; }

  /// Bytes up to the end of the last value.
  std::uint64_t size() {
    const std::uint64_t records = count();
    std::vector<std::uint64_t> length;
    for (std::uint64_t n = list(); n > 0; --n) {
      skip_name();
      length.push_back(count());
    }
    skip_attributes();
    std::uint64_t end = 0, record_bytes = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> per_record;  // begin, bytes of one record
    for (std::uint64_t n = list(); n > 0; --n) {
      const Variable v = variable(length);
      if (v.is_record) {
        per_record.emplace_back(v.begin, v.bytes);
        record_bytes += padded(v.bytes);
      } else {
        end = std::max(end, v.begin + v.bytes);
      }
    }
    if (per_record.size() == 1) record_bytes = per_record.front().second;  // the only one is not padded
    const bool is_streaming = records == (version_ == 5 ? ~std::uint64_t(0) : 0xffffffffu);
    for (const auto& [begin, bytes] : per_record)
      if (records > 0 && !is_streaming) end = std::max(end, begin + (records - 1) * record_bytes + bytes);
    return end;
  }

 private:
  struct Variable {
    std::uint64_t begin = 0, bytes = 0;
    bool is_record = false;
  };

  static std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }
  void read(char* to, std::streamsize n) {
    if (!in_.read(to, n)) throw Damaged{};
  }
  std::uint64_t number(int bytes) {
    std::array<char, 8> raw{};
    read(raw.data(), bytes);
    std::uint64_t value = 0;
    for (int k = 0; k < bytes; ++k) value = value << 8 | static_cast<unsigned char>(raw[std::size_t(k)]);
    return value;
  }
  std::uint64_t count() { return number(version_ == 5 ? 8 : 4); }
  /// Length of a list, behind its tag.
  std::uint64_t list() {
    number(4);
    return count();
  }
  void skip(std::uint64_t bytes) {
    if (bytes > (std::uint64_t(1) << 31)) throw Damaged{};
    in_.ignore(std::streamsize(padded(bytes)));
    if (!in_) throw Damaged{};
  }
  void skip_name() { skip(count()); }
  std::uint64_t bytes_of_type() {
    constexpr std::array<std::uint64_t, 12> bytes = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
    const std::uint64_t type = number(4);
    if (type < 1 || type >= bytes.size()) throw Damaged{};
    return bytes[type];
  }
  void skip_attributes() {
    for (std::uint64_t n = list(); n > 0; --n) {
      skip_name();
      const std::uint64_t each = bytes_of_type();
      skip(each * count());
    }
  }
  /// A variable varies by record if its first dimension has the length 0.
  Variable variable(const std::vector<std::uint64_t>& length) {
    Variable v;
    skip_name();
    const std::uint64_t dimensions = count();
    std::uint64_t values = 1;
    for (std::uint64_t d = 0; d < dimensions; ++d) {
      const std::uint64_t id = count();
      if (id >= length.size()) throw Damaged{};
      if (d == 0 && length[id] == 0)
        v.is_record = true;
      else
        values *= length[id];
    }
    skip_attributes();
    v.bytes = values * bytes_of_type();
    count();  // its size, which overflows for large variables
    v.begin = number(version_ == 1 ? 4 : 8);
    return v;
  }

  std::istream& in_;
  int version_ = 0;
  bool is_classic_ = false;
};

/// Formats whose cells lie in a file as they are, and the bytes before them.
struct RawFormat {
  const char* name;
  std::uint64_t header;
};
constexpr std::array<RawFormat, 12> kRawFormats = {{{"ENVI", 0},
                                                    {"EHdr", 0},
                                                    {"GenBin", 0},
                                                    {"SAGA", 0},
                                                    {"RST", 0},
                                                    {"ROI_PAC", 0},
                                                    {"ISCE", 0},
                                                    {"RRASTER", 0},
                                                    {"ERS", 0},
                                                    {"KRO", 20},
                                                    {"PCRaster", 256},
                                                    {"BT", 256}}};

[[noreturn]] void refuse_cut(const std::filesystem::path& file, std::uint64_t there, std::uint64_t needed) {
  throw InputError(file.string() + ": is cut off: it has " + std::to_string(there) + " bytes of " +
                   std::to_string(needed) + "; fetch it again");
}

std::uint64_t bits_of_cell(GDALRasterBand& band) {
  const char* bits = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE");
  return bits ? std::uint64_t(std::max(1, std::atoi(bits)))
              : std::uint64_t(GDALGetDataTypeSizeBits(band.GetRasterDataType()));
}

}  // namespace

void require_whole_netcdf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  try {
    Header header(in);
    if (!header.is_classic()) return;
    const std::uint64_t needed = header.size(), there = std::filesystem::file_size(file);
    if (there < needed) refuse_cut(file, there, needed);
  } catch (const Damaged&) {
    throw InputError(file.string() + ": its header is damaged or incomplete; fetch it again");
  }
}

void require_whole_raw(const std::filesystem::path& file, GDALDataset& dataset) {
  const auto* format = std::find_if(kRawFormats.begin(), kRawFormats.end(),
                                    [&](const RawFormat& f) { return EQUAL(f.name, dataset.GetDriverName()); });
  if (format == kRawFormats.end() || dataset.GetRasterCount() < 1) return;
  const char* packed = dataset.GetMetadataItem("file_compression", "ENVI");
  if (packed && std::atoi(packed) != 0) return;
  std::uint64_t bits = 0, largest = 0;
  for (int b = 1; b <= dataset.GetRasterCount(); ++b) bits += bits_of_cell(*dataset.GetRasterBand(b));
  const double cells = double(dataset.GetRasterXSize()) * dataset.GetRasterYSize();
  const auto needed = format->header + std::uint64_t(cells * double(bits) / 8);
  const CPLStringList files(dataset.GetFileList());
  for (int i = 0; i < files.size(); ++i) {
    std::error_code ec;
    const auto size = std::filesystem::file_size(files[i], ec);
    if (ec || EQUAL(CPLGetExtension(files[i]), "sg-grd-z")) return;
    largest = std::max<std::uint64_t>(largest, size);
  }
  if (largest < needed) refuse_cut(file, largest, needed);
}

void require_whole_points(const std::filesystem::path& file, GDALDataset& dataset) {
  if (!EQUAL(dataset.GetDriverName(), "XYZ")) return;
  std::ifstream in(file, std::ios::binary);
  const double cells = double(dataset.GetRasterXSize()) * dataset.GetRasterYSize();
  double points = 0;
  std::string line;
  while (std::getline(in, line)) {
    const auto first = line.find_first_not_of(" \t\r\"");
    points +=
        first != std::string::npos && std::string_view("0123456789+-.").find(line[first]) != std::string_view::npos;
    if (in.eof() && points < cells)  // the last line, without an end
      throw InputError(file.string() + ": is cut off: its last line has no end, and the grid of its points has " +
                       std::to_string(std::uint64_t(cells)) + " cells for " + std::to_string(std::uint64_t(points)) +
                       " points; fetch it again");
  }
}

}  // namespace gonogo::terrain
