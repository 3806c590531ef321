#include "sim/io/vtk_series.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "sim/shape/touch/touch.h"

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

namespace {

constexpr const char* kKinds[] = {"spheres", "surfaces", "contacts"};

std::string file_name(const std::string& kind, int frame) { return kind + line("_%06d.vtp", frame); }

VtpContent sphere_content(const Capture& frame, const std::vector<Shape>& shapes) {
  VtpContent content;
  std::vector<float> radius, speed;
  std::vector<std::int32_t> body, material;
  std::vector<Vec3> velocity, angular_velocity;
  for (const Shape& s : shapes) {
    if (s.type != ShapeType::sphere) continue;
    const BodyState& b = frame.body[s.body];
    content.point.push_back(centre_of(s, b));
    radius.push_back(s.size.x);
    velocity.push_back(velocity_of(s, b));
    angular_velocity.push_back(b.angular_velocity);
    speed.push_back(length(velocity.back()));
    body.push_back(s.body);
    material.push_back(s.material);
  }
  content.array = {{"radius", std::move(radius)},
                   {"velocity", std::move(velocity)},
                   {"angular_velocity", std::move(angular_velocity)},
                   {"speed", std::move(speed)},
                   {"body", std::move(body)},
                   {"material", std::move(material)}};
  return content;
}

VtpContent surface_content(const Capture& frame, const SceneWorld& drawn, Real plane_half) {
  VtpContent content;
  std::vector<std::int32_t> body, material;
  std::vector<Vec3> normal, velocity;
  for (const Shape& s : drawn.shape) {
    if (s.type == ShapeType::sphere) continue;
    const Surface surface = surface_of(drawn, s, {48, plane_half});
    const BodyState& b = frame.body[s.body];
    const Vec3d centre = centre_of(s, b);
    const Quat q = shape_orientation(s, b.orientation);
    const auto first = Index(content.point.size());
    for (const auto& t : surface.triangle) content.triangle.push_back({first + t[0], first + t[1], first + t[2]});
    for (std::size_t i = 0; i < surface.point.size(); ++i) {
      const Vec3 from_centre = rotate(q, surface.point[i]);
      content.point.push_back(centre + static_cast<Vec3d>(from_centre));
      normal.push_back(rotate(q, surface.normal[i]));
      velocity.push_back(velocity_of(s, b) + cross(b.angular_velocity, from_centre));
    }
    body.resize(content.point.size(), s.body);
    material.resize(content.point.size(), s.material);
  }
  content.array = {{"Normals", std::move(normal)},
                   {"velocity", std::move(velocity)},
                   {"body", std::move(body)},
                   {"material", std::move(material)}};
  return content;
}

VtpContent contact_content(const Capture& frame) {
  VtpContent content;
  std::vector<float> gap;
  std::vector<std::int32_t> body_a, body_b;
  std::vector<Vec3> normal, impulse;
  for (const CapturedContact& c : frame.contact) {
    content.point.push_back(c.point);
    normal.push_back(c.normal);
    impulse.push_back(c.impulse);
    gap.push_back(c.gap);
    body_a.push_back(c.a);
    body_b.push_back(c.b);
  }
  content.array = {{"normal", std::move(normal)},
                   {"impulse", std::move(impulse)},
                   {"gap", std::move(gap)},
                   {"body_a", std::move(body_a)},
                   {"body_b", std::move(body_b)}};
  return content;
}

}  // namespace

VtkSeries::VtkSeries(std::filesystem::path folder, const SceneWorld& world)
    : folder_(std::move(folder)), plane_half_(Real(std::max({world.size.x, world.size.y, world.size.z}) / 2)) {
  drawn_.shape = world.shape;
  drawn_.mesh = world.mesh;
  drawn_.heightfield = world.heightfield;
  create_folder(folder_);
  for (const char* kind : kKinds) write_collection(kind);
}

void VtkSeries::write(const Capture& frame) {
  const int k = frame_count();
  const std::array content{sphere_content(frame, drawn_.shape), surface_content(frame, drawn_, plane_half_),
                           contact_content(frame)};
  for (int i = 0; i < 3; ++i) {
    VtpContent timed = content[i];
    timed.time = frame.time;
    write_vtp(folder_ / file_name(kKinds[i], k), timed);
  }
  time_.push_back(frame.time);
  for (const char* kind : kKinds) write_collection(kind);
}

void VtkSeries::write_collection(const std::string& kind) const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (int k = 0; k < frame_count(); ++k)
    text +=
        line("    <DataSet timestep=\"%.9g\" group=\"\" part=\"0\" file=\"", time_[k]) + file_name(kind, k) + "\"/>\n";
  write_file_atomically(folder_ / (kind + ".pvd"), text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace gonogo::sim
