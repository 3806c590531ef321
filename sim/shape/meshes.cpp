#include "sim/shape/meshes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>
#include <tuple>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::sim {
namespace {

/// Adds each vertex once, by its exact position.
class Welder {
 public:
  explicit Welder(TriangleMesh& mesh) : mesh_(mesh) {}
  Index add(const Vec3& p) {
    const auto [at, is_new] = index_.try_emplace({p.x, p.y, p.z}, Index(mesh_.vertex.size()));
    if (is_new) mesh_.vertex.push_back(p);
    return at->second;
  }

 private:
  TriangleMesh& mesh_;
  std::map<std::tuple<Real, Real, Real>, Index> index_;
};

/// Squares over corner + u [0, 1] + v [0, 1]; u x v points outward.
void add_grid(TriangleMesh& mesh, Welder& weld, const Vec3& corner, const Vec3& u, const Vec3& v, int cells) {
  const auto at = [&](int i, int j) {
    // Ends exactly on the corners, so that faces share them.
    const Real a = i == cells ? Real(1) : Real(i) / Real(cells), b = j == cells ? Real(1) : Real(j) / Real(cells);
    return weld.add(corner + u * a + v * b);
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      mesh.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
}

/// Prism about y over a polygon (x, z) that is star-shaped about the axis and runs from z towards x.
TriangleMesh prism(const std::vector<std::pair<Real, Real>>& outline, Real half_length) {
  TriangleMesh mesh;
  const auto n = Index(outline.size());
  for (const Real y : {-half_length, half_length}) {
    for (const auto& [x, z] : outline) mesh.vertex.push_back({x, y, z});
    mesh.vertex.push_back({0, y, 0});
  }
  for (Index k = 0; k < n; ++k) {
    const Index here = k, next = (k + 1) % n, up = n + 1;
    mesh.triangle.push_back({here, next, next + up});
    mesh.triangle.push_back({here, next + up, here + up});
    mesh.triangle.push_back({n, next, here});                 // y < 0
    mesh.triangle.push_back({n + up, here + up, next + up});  // y > 0
  }
  return mesh;
}

std::pair<Real, Real> on_rim(double radius, double angle) {
  return {Real(radius * std::sin(angle)), Real(radius * std::cos(angle))};
}

}  // namespace

TriangleMesh box_mesh(const Vec3& h, int cells) {
  TriangleMesh mesh;
  mesh.name = "box";
  Welder weld(mesh);
  const Vec3 x{2 * h.x, 0, 0}, y{0, 2 * h.y, 0}, z{0, 0, 2 * h.z};
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, y, x, cells);
  add_grid(mesh, weld, {-h.x, -h.y, h.z}, x, y, cells);
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, x, z, cells);
  add_grid(mesh, weld, {-h.x, h.y, -h.z}, z, x, cells);
  add_grid(mesh, weld, {-h.x, -h.y, -h.z}, z, y, cells);
  add_grid(mesh, weld, {h.x, -h.y, -h.z}, y, z, cells);
  return mesh;
}

TriangleMesh cylinder_mesh(Real radius, Real half_length, int segments) {
  if (segments < 3) throw InputError("a cylinder mesh needs at least 3 segments");
  std::vector<std::pair<Real, Real>> outline;
  for (int k = 0; k < segments; ++k) outline.push_back(on_rim(radius, 2 * kPi * k / segments));
  TriangleMesh mesh = prism(outline, half_length);
  mesh.name = "cylinder";
  return mesh;
}

TriangleMesh tyre_mesh(const Shape& wheel, int segments) {
  const double radius = wheel.size.x, tip = radius + wheel.size.z, half = 0.5 * double(wheel.lug_thickness);
  const double pitch = wheel.lug_count > 0 ? 2 * kPi / wheel.lug_count : 0, foot = std::asin(half / radius);
  if (wheel.lug_count == 0) return cylinder_mesh(wheel.size.x, wheel.size.y, segments);
  if (!(2 * foot < pitch)) throw InputError("the lugs of the tyre leave no room between them");
  std::vector<std::pair<Real, Real>> outline;
  for (int lug = 0; lug < wheel.lug_count; ++lug) {
    // Lug k of a wheel lies at the angle k pitch from x towards z; outlines run the other way, from z towards x.
    const double middle = kPi / 2 + lug * pitch;
    const double s = std::sin(middle), c = std::cos(middle);
    outline.push_back(on_rim(radius, middle - foot));
    outline.push_back({Real(tip * s - half * c), Real(tip * c + half * s)});
    outline.push_back({Real(tip * s + half * c), Real(tip * c - half * s)});
    for (int k = 0; k < segments; ++k)
      outline.push_back(on_rim(radius, middle + foot + (pitch - 2 * foot) * k / segments));
  }
  TriangleMesh mesh = prism(outline, wheel.size.y);
  mesh.name = "tyre";
  return mesh;
}

TriangleMesh revolved_mesh(const std::vector<std::pair<Real, Real>>& profile, int segments) {
  if (segments < 3 || profile.size() < 3)
    throw InputError("a solid of revolution needs at least 3 segments and 3 points of its profile");
  TriangleMesh mesh;
  mesh.name = "solid of revolution";
  const auto n = Index(profile.size());
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * kPi * k / segments, c = std::cos(angle), s = std::sin(angle);
    for (const auto& [r, z] : profile) {
      if (!(r > 0)) throw InputError("a solid of revolution must keep off its axis");
      mesh.vertex.push_back({Real(r * c), Real(r * s), z});
    }
  }
  for (int k = 0; k < segments; ++k)
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + 1) % n, here = k * n, next = (k + 1) % segments * n;
      mesh.triangle.push_back({here + i, next + j, here + j});
      mesh.triangle.push_back({here + i, next + i, next + j});
    }
  return mesh;
}

TriangleMesh floor_mesh(Real half_edge, int cells) {
  TriangleMesh mesh{.name = "floor", .open = true};
  Welder weld(mesh);
  add_grid(mesh, weld, {-half_edge, -half_edge, 0}, {2 * half_edge, 0, 0}, {0, 2 * half_edge, 0}, cells);
  return mesh;
}

namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of binary STL: header with the count, one triangle

/// Words of a text with the line they are on.
class Words {
 public:
  Words(const std::string& file, std::string_view text) : file_(file), rest_(text) {}

  /// Empty at the end.
  std::string_view next() {
    while (!rest_.empty() && is_space(rest_.front())) {
      line_ += rest_.front() == '\n';
      rest_.remove_prefix(1);
    }
    std::size_t n = 0;
    while (n < rest_.size() && !is_space(rest_[n])) ++n;
    const std::string_view word = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return word;
  }

  /// The rest of the present line.
  std::string_view rest_of_line() {
    const std::size_t n = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return line;
  }

  void expect(std::string_view word) {
    const std::string_view got = next();
    if (got != word) refuse("expected \"" + std::string(word) + "\", found \"" + std::string(got) + "\"");
  }

  Real number(std::string_view word) {
    if (const auto value = parsed<double>(word)) return Real(*value);
    refuse("expected a number, found \"" + std::string(word) + "\"");
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(file_ + ", line " + std::to_string(line_) + ": " + why);
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string file_;
  std::string_view rest_;
  int line_ = 1;
};

void read_binary_stl(const std::string& text, TriangleMesh& mesh) {
  Welder weld(mesh);
  for (std::size_t at = kHeader; at + kFacet <= text.size(); at += kFacet) {
    float number[12];  // normal, three corners; the normal is left to the order of the corners
    std::memcpy(number, text.data() + at, sizeof number);
    std::array<Index, 3> corner;
    for (int k = 0; k < 3; ++k) corner[k] = weld.add({number[3 + 3 * k], number[4 + 3 * k], number[5 + 3 * k]});
    mesh.triangle.push_back(corner);
  }
}

void read_text_stl(const std::string& file, const std::string& text, TriangleMesh& mesh) {
  Words words(file, text);
  Welder weld(mesh);
  words.expect("solid");
  words.rest_of_line();
  for (std::string_view word = words.next(); word != "endsolid"; word = words.next()) {
    if (word != "facet") words.refuse("expected \"facet\" or \"endsolid\", found \"" + std::string(word) + "\"");
    words.expect("normal");
    for (int k = 0; k < 3; ++k) words.number(words.next());
    words.expect("outer");
    words.expect("loop");
    std::array<Index, 3> corner;
    for (Index& v : corner) {
      words.expect("vertex");
      const Real x = words.number(words.next()), y = words.number(words.next()), z = words.number(words.next());
      v = weld.add({x, y, z});
    }
    mesh.triangle.push_back(corner);
    words.expect("endloop");
    words.expect("endfacet");
  }
}

void read_stl(const std::string& file, const std::string& text, TriangleMesh& mesh) {
  std::uint32_t count = 0;
  if (text.size() >= kHeader) std::memcpy(&count, text.data() + 80, sizeof count);
  if (text.size() >= kHeader && text.size() == kHeader + kFacet * std::size_t(count)) {
    read_binary_stl(text, mesh);
  } else if (text.compare(0, 5, "solid") == 0) {
    read_text_stl(file, text, mesh);
  } else {
    throw InputError(file + ": it is no STL file: it does not begin with \"solid\", and as a binary file of " +
                     std::to_string(count) + " triangles it would have " +
                     std::to_string(kHeader + kFacet * std::size_t(count)) + " bytes, not " +
                     std::to_string(text.size()));
  }
}

/// Corner of an OBJ face: "7", "7/1", "7//3" or "-1" for the last vertex so far.
Index obj_vertex(Words& words, std::string_view word, const std::vector<Index>& vertex) {
  const int value = parsed<int>(word.substr(0, word.find('/'))).value_or(0);
  const int index = value > 0 ? value - 1 : int(vertex.size()) + value;
  if (value == 0 || index < 0 || index >= int(vertex.size()))
    words.refuse("a face has the corner \"" + std::string(word) + "\"; there are " + std::to_string(vertex.size()) +
                 " vertices before it, counted from 1");
  return vertex[index];
}

void read_obj(const std::string& file, const std::string& text, TriangleMesh& mesh) {
  Words words(file, text);
  Welder weld(mesh);
  std::vector<Index> vertex;  // in the file's order
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "v") {
      const Real x = words.number(words.next()), y = words.number(words.next()), z = words.number(words.next());
      vertex.push_back(weld.add({x, y, z}));
    } else if (word == "f") {
      std::vector<Index> corner;
      Words line(file, words.rest_of_line());
      for (std::string_view c = line.next(); !c.empty(); c = line.next())
        corner.push_back(obj_vertex(words, c, vertex));
      if (corner.size() < 3) words.refuse("a face needs three corners, found " + std::to_string(corner.size()));
      for (std::size_t k = 2; k < corner.size(); ++k) mesh.triangle.push_back({corner[0], corner[k - 1], corner[k]});
      continue;
    }
    words.rest_of_line();
  }
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path, double scale, bool open) {
  if (!(scale > 0)) throw InputError(path.string() + ": the scale must be above zero");
  const std::string text = read_file(path);
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  TriangleMesh mesh{.name = path.string(), .open = open};
  if (ending == ".stl")
    read_stl(path.string(), text, mesh);
  else if (ending == ".obj")
    read_obj(path.string(), text, mesh);
  else
    throw InputError(path.string() + ": a mesh file must end in .stl or .obj");
  for (Vec3& p : mesh.vertex) p = static_cast<Vec3>(static_cast<Vec3d>(p) * scale);
  check_mesh(mesh);
  return mesh;
}

void write_stl(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text(80, ' ');
  const auto put = [&](const void* data, std::size_t size) { text.append(static_cast<const char*>(data), size); };
  const auto count = std::uint32_t(mesh.triangle.size());
  put(&count, sizeof count);
  for (const auto& [a, b, c] : mesh.triangle) {
    const Vec3 &p = mesh.vertex[a], &q = mesh.vertex[b], &r = mesh.vertex[c], n = cross(q - p, r - p);
    for (const Vec3& v : {n * (1 / length(n)), p, q, r}) put(&v, sizeof v);
    const std::uint16_t attribute = 0;
    put(&attribute, sizeof attribute);
  }
  write_file_atomically(path, text);
}

}  // namespace gonogo::sim
