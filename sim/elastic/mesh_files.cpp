#include "sim/elastic/mesh_files.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"

namespace gonogo::sim::elastic {
namespace {

/// Words of a text with the line they stand on.
class Words {
 public:
  Words(std::string name, const std::string& text) : name_(std::move(name)), in_(text) {}

  std::string line_text() {
    std::string text;
    if (!std::getline(in_, text)) fail("the file ends too early");
    ++line_;
    if (!text.empty() && text.back() == '\r') text.pop_back();
    return text;
  }
  bool at_end() { return (in_ >> std::ws).eof(); }
  /// Numbers of the next line; at least `least` of them.
  std::vector<double> numbers(std::size_t least) {
    const std::string text = line_text();
    std::istringstream row(text);
    std::vector<double> all;
    for (double x; row >> x;) all.push_back(x);
    if (!row.eof() || all.size() < least)
      fail("'" + text.substr(0, 40) + "' should be at least " + std::to_string(least) + " numbers");
    return all;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + what +
                     "; write the mesh with gmsh -format msh41 (text)");
  }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::istringstream in_;
  std::size_t line_ = 0;
};

struct Block {  // elements of one entity
  int dimension = 0, entity = 0, type = 0;
  std::vector<std::vector<long>> corner;  // by tag of the node
};

struct Content {
  std::map<std::pair<int, int>, std::string> physical_name;     // dimension, number
  std::map<std::pair<int, int>, std::vector<int>> physical_of;  // dimension, entity
  std::map<long, Vec3d> node;                                   // by tag
  std::vector<Block> block;
};

/// Corners by Gmsh's type of element; 0: not read here.
int corners_of(int type) {
  constexpr int corners[] = {0, 2, 3, 4, 4, 8};  // edge, triangle, quadrangle, tetrahedron, hexahedron
  return type == 15 ? 1 : type > 0 && type <= 5 ? corners[type] : 0;
}

void read_format(Words& in, Content&) {
  const std::vector<double> v = in.numbers(3);
  if (std::fabs(v[0] - 4.1) > 1e-9) in.fail(line("format is %g; only 4.1 is read", v[0]));
  if (v[1] != 0) in.fail("the file is binary; only text is read");
}

void read_names(Words& in, Content& c) {
  const auto count = long(in.numbers(1)[0]);
  for (long i = 0; i < count; ++i) {
    std::istringstream row(in.line_text());
    int dimension = 0, number = 0;
    std::string name;
    if (!(row >> dimension >> number) || !std::getline(row >> std::ws, name) || name.size() < 2)
      in.fail("a physical name should be dimension, number and a name in quotes");
    c.physical_name[{dimension, number}] = name.substr(1, name.rfind('"') - 1);
  }
}

void read_entities(Words& in, Content& c) {
  const std::vector<double> counts = in.numbers(4);
  for (int d = 0; d < 4; ++d)
    for (long i = 0; i < long(counts[std::size_t(d)]); ++i) {
      const std::size_t groups_at = d == 0 ? 4 : 7;
      const std::vector<double> v = in.numbers(groups_at + 1);
      const auto groups = std::size_t(v[groups_at]);
      if (v.size() < groups_at + 1 + groups) in.fail("an entity names fewer physical groups than it says");
      for (std::size_t g = 0; g < groups; ++g)
        c.physical_of[{d, int(v[0])}].push_back(std::abs(int(v[groups_at + 1 + g])));
    }
}

void read_nodes(Words& in, Content& c) {
  const auto blocks = long(in.numbers(4)[0]);
  for (long b = 0; b < blocks; ++b) {
    const auto count = long(in.numbers(4)[3]);
    std::vector<long> tag;
    for (long i = 0; i < count; ++i) tag.push_back(long(in.numbers(1)[0]));
    for (const long t : tag) {
      const std::vector<double> x = in.numbers(3);
      c.node[t] = {x[0], x[1], x[2]};
    }
  }
}

void read_elements(Words& in, Content& c) {
  const auto blocks = long(in.numbers(4)[0]);
  for (long b = 0; b < blocks; ++b) {
    const std::vector<double> head = in.numbers(4);
    Block block{int(head[0]), int(head[1]), int(head[2]), {}};
    const int corners = corners_of(block.type);
    if (corners == 0)
      in.fail(
          line("elements of type %d are not read, only first-order lines, triangles, quadrilaterals, tetrahedra and "
               "hexahedra",
               block.type));
    for (long i = 0; i < long(head[3]); ++i) {
      const std::vector<double> v = in.numbers(std::size_t(corners) + 1);
      block.corner.emplace_back();
      for (int k = 0; k < corners; ++k) block.corner.back().push_back(long(v[std::size_t(k) + 1]));
    }
    c.block.push_back(std::move(block));
  }
}

Content read_content(Words& in) {
  using Reader = void (*)(Words&, Content&);
  const std::map<std::string, Reader> readers{{"MeshFormat", read_format},
                                              {"PhysicalNames", read_names},
                                              {"Entities", read_entities},
                                              {"Nodes", read_nodes},
                                              {"Elements", read_elements}};
  Content c;
  bool first = true;
  while (!in.at_end()) {
    const std::string head = in.line_text();
    if (head.empty()) continue;
    const std::string name = head.substr(1);
    if (head[0] != '$' || (first && name != "MeshFormat"))
      in.fail("'" + head.substr(0, 40) + "' should be $MeshFormat");
    first = false;
    const auto reader = readers.find(name);
    if (reader != readers.end()) reader->second(in, c);
    while (in.line_text() != "$End" + name) {
      if (reader != readers.end()) in.fail("expected $End" + name);
    }
  }
  return c;
}

ElementKind kind_of(const Content& c, int dimension, const Words& in) {
  int type = 0;
  for (const Block& b : c.block)
    if (b.dimension == dimension) {
      if (type != 0 && type != b.type) in.fail("elements of two kinds; a body has one kind");
      type = b.type;
    }
  return type == 2 ? ElementKind::t3 : type == 3 ? ElementKind::q4 : type == 4 ? ElementKind::t4 : ElementKind::h8;
}

void add_groups(const Content& c, int dimension, const std::map<long, Index>& index, Mesh& mesh) {
  std::map<std::set<Index>, Face> by_corners;
  for (const Face& f : boundary_faces(mesh)) by_corners[{f.node.begin(), f.node.begin() + f.count}] = f;
  for (const Block& b : c.block) {
    const auto groups = c.physical_of.find({b.dimension, b.entity});
    if (b.dimension != dimension - 1 || groups == c.physical_of.end()) continue;
    for (const std::vector<long>& corners : b.corner) {
      std::set<Index> key;
      for (const long t : corners)
        if (const auto at = index.find(t); at != index.end()) key.insert(at->second);
      const auto face = by_corners.find(key);
      if (face == by_corners.end()) continue;  // inside the body
      for (const int g : groups->second) {
        const auto name = c.physical_name.find({b.dimension, g});
        mesh.group[name == c.physical_name.end() ? std::to_string(g) : name->second].push_back(face->second);
      }
    }
  }
}

}  // namespace

Mesh read_gmsh(const std::filesystem::path& path, double scale) {
  if (!(scale > 0)) throw InputError(path.string() + line(": scale is %g; it must be above 0", scale));
  Words in(path.string(), read_file(path));
  const Content c = read_content(in);
  int dimension = 0;
  for (const Block& b : c.block) dimension = std::max(dimension, b.dimension);
  if (dimension < 2) in.fail("no triangle, quadrilateral, tetrahedron or hexahedron");
  Mesh mesh;
  mesh.kind = kind_of(c, dimension, in);
  std::map<long, Index> index;
  for (const Block& b : c.block) {
    if (b.dimension != dimension) continue;
    for (const std::vector<long>& corners : b.corner) {
      std::array<Index, 8> element{};
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto node = c.node.find(corners[k]);
        if (node == c.node.end()) in.fail("an element names node " + std::to_string(corners[k]) + ", which is missing");
        if (dimension == 2 && std::fabs(node->second.z) > 0) in.fail("a 2-D mesh has a node off the plane z = 0");
        const auto [at, added] = index.try_emplace(corners[k], Index(mesh.node.size()));
        if (added) mesh.node.push_back(node->second * scale);
        element[k] = at->second;
      }
      mesh.element.push_back(element);
    }
  }
  check_mesh(mesh, path.string());
  add_groups(c, dimension, index, mesh);
  return mesh;
}

namespace {

std::string head_of(const char* type, const char* name, int components) {
  return line("        <DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"ascii\">\n", type, name,
              components);
}

template <class Value>
std::string vectors(const char* name, std::size_t count, const Value& value) {
  std::string text = head_of("Float64", name, 3);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d x = value(i);
    text += line("%.9g %.9g %.9g\n", x.x, x.y, x.z);
  }
  return text + "        </DataArray>\n";
}

double von_mises(const std::array<double, 6>& s) {
  const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
  return std::sqrt((a * a + b * b + c * c) / 2 + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

std::string stresses(const std::vector<std::array<double, 6>>& stress) {
  std::string all = head_of("Float64", "stress", 6), mises = head_of("Float64", "von_mises", 1);
  for (const auto& s : stress) {
    all += line("%.9g %.9g %.9g %.9g %.9g %.9g\n", s[0], s[1], s[2], s[3], s[4], s[5]);
    mises += line("%.9g\n", von_mises(s));
  }
  return all + "        </DataArray>\n" + mises + "        </DataArray>\n";
}

std::string cells(const Mesh& mesh) {
  const int corners = corner_count(mesh.kind);
  const int type = mesh.kind == ElementKind::t3   ? 5
                   : mesh.kind == ElementKind::q4 ? 9
                   : mesh.kind == ElementKind::t4 ? 10
                                                  : 12;
  std::string nodes, ends, types;
  for (std::size_t e = 0; e < mesh.element.size(); ++e) {
    for (int k = 0; k < corners; ++k)
      nodes += std::to_string(mesh.element[e][std::size_t(k)]) + (k + 1 < corners ? " " : "\n");
    ends += std::to_string((e + 1) * std::size_t(corners)) + "\n";
    types += std::to_string(type) + "\n";
  }
  const std::string end = "        </DataArray>\n";
  return "      <Cells>\n" + head_of("Int64", "connectivity", 1) + nodes + end + head_of("Int64", "offsets", 1) + ends +
         end + head_of("UInt8", "types", 1) + types + end + "      </Cells>\n";
}

}  // namespace

std::string vtu_bytes(const Simulation& simulation, int body) {
  const Mesh& mesh = simulation.model().body.at(std::size_t(body)).mesh;
  const std::size_t count = mesh.node.size();
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "  <UnstructuredGrid>\n    <FieldData>\n" +
         line(
             "      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
             "format=\"ascii\">%.9g</DataArray>\n",
             simulation.state().time) +
         line("    </FieldData>\n    <Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n      <Points>\n", count,
              mesh.element.size()) +
         vectors("Points", count, [&](std::size_t i) { return mesh.node[i]; }) + "      </Points>\n" + cells(mesh) +
         "      <PointData>\n" +
         vectors("displacement", count, [&](std::size_t i) { return simulation.displacement(body, Index(i)); }) +
         vectors("velocity", count, [&](std::size_t i) { return simulation.velocity(body, Index(i)); }) +
         stresses(simulation.node_stress(body)) +
         "      </PointData>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";
}

void write_vtu(const std::filesystem::path& path, const Simulation& simulation, int body) {
  write_file_atomically(path, vtu_bytes(simulation, body));
}

}  // namespace gonogo::sim::elastic
