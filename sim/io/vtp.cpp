#include "sim/io/vtp.h"

#include <bit>

#include "base/error.h"
#include "base/file.h"

namespace gonogo::sim {
namespace {

/// XML elements that name arrays by their offset, and the raw bytes they point into.
class Document {
 public:
  template <class T>
  void array(const char* type, const std::string& name, int components, const std::vector<T>& values,
             const std::string& more = "") {
    xml_ += "        <DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
            std::to_string(components) + "\"" + more + " format=\"appended\" offset=\"" + std::to_string(raw_.size()) +
            "\"/>\n";
    const std::uint64_t bytes = values.size() * sizeof(T);
    raw_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    raw_.append(reinterpret_cast<const char*>(values.data()), bytes);
  }
  void line(const std::string& text) { xml_ += text + "\n"; }

  std::string bytes() const {
    const char* order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    return std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"") + order +
           "\" header_type=\"UInt64\">\n" + xml_ + "  <AppendedData encoding=\"raw\">\n_" + raw_ +
           "\n  </AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string xml_, raw_;
};

struct StoreValues {
  Document& out;
  const std::string& name;
  void operator()(const std::vector<float>& v) const { out.array("Float32", name, 1, v); }
  void operator()(const std::vector<std::int32_t>& v) const { out.array("Int32", name, 1, v); }
  void operator()(const std::vector<Vec3>& v) const { out.array("Float32", name, 3, v); }
};

/// Cells with `corners` points each: their points one after the other, and where each cell ends.
void store_cells(Document& out, const char* kind, const std::vector<std::int64_t>& connectivity, int corners) {
  std::vector<std::int64_t> ends;
  for (std::size_t end = corners; end <= connectivity.size(); end += corners) ends.push_back(std::int64_t(end));
  out.line(std::string("      <") + kind + ">");
  out.array("Int64", "connectivity", 1, connectivity);
  out.array("Int64", "offsets", 1, ends);
  out.line(std::string("      </") + kind + ">");
}

void check_lengths(const VtpContent& content) {
  for (const VtpArray& a : content.array)
    if (std::visit([](const auto& v) { return v.size(); }, a.values) != content.point.size())
      throw InputError("VTK array '" + a.name + "': needs one value per point, " +
                       std::to_string(content.point.size()));
}

}  // namespace

std::string vtp_bytes(const VtpContent& content) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(Vec3d) == 3 * sizeof(double), "written as bytes");
  check_lengths(content);
  const bool vertices = content.triangle.empty();
  std::vector<std::int64_t> corners;
  for (const auto& t : content.triangle) corners.insert(corners.end(), t.begin(), t.end());
  if (vertices)
    for (std::size_t i = 0; i < content.point.size(); ++i) corners.push_back(std::int64_t(i));
  Document out;
  out.line("  <PolyData>");
  out.line("    <FieldData>");
  out.array("Float64", "TimeValue", 1, std::vector<double>{content.time}, " NumberOfTuples=\"1\"");
  out.line("    </FieldData>");
  out.line("    <Piece NumberOfPoints=\"" + std::to_string(content.point.size()) + "\" NumberOfVerts=\"" +
           std::to_string(vertices ? corners.size() : 0) + "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" " +
           "NumberOfPolys=\"" + std::to_string(content.triangle.size()) + "\">");
  out.line("      <Points>");
  out.array("Float64", "Points", 3, content.point);
  out.line("      </Points>");
  out.line("      <PointData>");
  for (const VtpArray& a : content.array) std::visit(StoreValues{out, a.name}, a.values);
  out.line("      </PointData>");
  store_cells(out, vertices ? "Verts" : "Polys", corners, vertices ? 1 : 3);
  out.line("    </Piece>");
  out.line("  </PolyData>");
  return out.bytes();
}

void write_vtp(const std::filesystem::path& path, const VtpContent& content) {
  write_file_atomically(path, vtp_bytes(content));
}

}  // namespace gonogo::sim
