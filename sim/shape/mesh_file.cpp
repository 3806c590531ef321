#include "sim/shape/mesh_file.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "sim/shape/welder.h"

namespace gonogo::sim {
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
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      refuse("expected a number, found \"" + std::string(word) + "\"");
    return Real(value);
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
  const std::string_view digits = word.substr(0, word.find('/'));
  int value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const int index = value > 0 ? value - 1 : int(vertex.size()) + value;
  if (error != std::errc() || end != digits.data() + digits.size() || value == 0 || index < 0 ||
      index >= int(vertex.size()))
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
  TriangleMesh mesh;
  mesh.name = path.string();
  mesh.open = open;
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
