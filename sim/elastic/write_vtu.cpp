#include "sim/elastic/write_vtu.h"

#include <cmath>

#include "base/file.h"
#include "base/line.h"

namespace gonogo::sim::elastic {
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
