// Bad input gets one sentence that names the part, the value and what is allowed.
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/files/file.h"
#include "sim/elastic/mesh.h"
#include "sim/elastic/mesh_files.h"
#include "sim/elastic/simulation.h"
#include "tests/support/catch.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim::elastic;

template <class Act>
std::string said(const Act& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Model good() {
  Model m;
  m.body = {{"block", make_rectangle(even(0, 1, 2), even(0, 1, 2)), {1e7, 0.3, 1000}}};
  const auto bottom = nodes_where(m.body[0].mesh, [](const Vec3d& x) { return x.y < 1e-9; });
  m.fixed = {{0, bottom, 0}, {0, bottom, 1}};
  Contact c;
  c.name = "top";
  c.face = faces_where(m.body[0].mesh, [](const Vec3d& x) { return x.y > 0.99; });
  c.shape.point = {0, 2, 0};
  c.shape.axis = {0, -1, 0};
  c.law.c_n = 1e9;
  m.contact.push_back(c);
  return m;
}

/// What the model with one change is refused with.
template <class Change>
std::string refused(const Change& change) {
  Model m = good();
  change(m);
  return said([&] { Simulation s(m); });
}

std::string read_text(const std::string& text) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_elastic_bad.msh";
  write_file_atomically(path, text);
  std::string message = said([&] { read_gmsh(path); });
  std::filesystem::remove(path);
  return message;
}

const char* const kSquare =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 7 \"bottom side\"\n$EndPhysicalNames\n"
    "$Entities\n0 1 1 0\n1 0 0 0 1 0 0 1 7 0\n1 0 0 0 1 1 0 0 1 1\n$EndEntities\n"
    "$Nodes\n1 4 1 12\n2 1 0 4\n1\n2\n11\n12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
    "$Elements\n2 3 1 3\n1 1 1 1\n1 1 2\n2 1 2 2\n2 1 2 11\n3 1 11 12\n$EndElements\n";

}  // namespace

TEST_CASE("A good model is taken") {
  CHECK(refused([](Model&) {}).empty());
}

TEST_CASE("Bad meshes are refused") {
  CHECK(has(refused([](Model& m) { std::swap(m.body[0].mesh.element[1][1], m.body[0].mesh.element[1][3]); }),
            "block: element 1 is inverted"));
  CHECK(has(refused([](Model& m) {
              auto& e = m.body[0].mesh.element[0];
              m.body[0].mesh.node[std::size_t(e[2])] = m.body[0].mesh.node[std::size_t(e[1])];
              m.body[0].mesh.node[std::size_t(e[3])] = m.body[0].mesh.node[std::size_t(e[0])];
            }),
            "block: element 0 is degenerate"));
  CHECK(has(refused([](Model& m) { m.body[0].mesh.element[0][0] = 99; }), "has corner 99; nodes are 0 to 8"));
  CHECK(has(refused([](Model& m) { m.body[0].mesh.element[0][0] = m.body[0].mesh.element[0][1]; }), "twice"));
  CHECK(has(refused([](Model& m) { m.body[0].mesh.node.push_back({5, 5, 0}); }), "node 9 belongs to no element"));
  CHECK(has(refused([](Model& m) { m.body[0].mesh.element.clear(); }), "no element"));
}

TEST_CASE("Bad numbers are refused") {
  CHECK(has(refused([](Model& m) { m.body[0].material.young = -1; }), "Young's modulus is -1 Pa"));
  CHECK(has(refused([](Model& m) { m.body[0].material.poisson = 0.5; }), "Poisson's ratio is 0.5"));
  CHECK(has(refused([](Model& m) { m.contact[0].law.c_n = -5; }), "top: stiffness c_n is -5"));
  CHECK(has(refused([](Model& m) { m.contact[0].law.c_t = -5; }), "top: friction c_t is -5"));
  CHECK(
      has(refused([](Model& m) { m.contact[0].law.m_n = 0.5; }), "exponent m_n is 0.5; allowed is 1 and above in 2-D"));
  CHECK(has(refused([](Model& m) { m.contact[0].law = {.c_n = 1, .c_t = 1, .epsilon = 0}; }), "epsilon is 0 m/s"));
  CHECK(has(refused([](Model& m) { m.contact[0].points = 6; }), "6 Gauss points; allowed are 1 to 5"));
  CHECK(has(refused([](Model& m) { m.contact[0].shape.axis = {0, 2, 0}; }), "length 2; it must be 1"));
  CHECK(has(refused([](Model& m) { m.fixed[0].component = 2; }), "components are 0 to 1"));
  CHECK(has(refused([](Model& m) { m.fixed[0].body = 3; }), "names body 3; bodies are 0 to 0"));
  CHECK(has(said([] { check_law({.c_n = 1, .m_n = 3.5}, 3, "tyre"); }),
            "tyre: exponent m_n is 3.5; allowed is 1 to 3 in 3-D"));
  CHECK(said([] { check_law({.c_n = 1, .m_n = 3.5}, 2, "tyre"); }).empty());
  CHECK(has(said([] { rough_law({.density = 0}, 1e-3); }), "density 0 1/m^2"));
  CHECK(has(said([] { even(1, 0, 3); }), "from < to"));
}

TEST_CASE("A body that nothing holds has no statics") {
  Model m = good();
  m.contact.clear();
  m.fixed = {{0, {0}, 0}, {0, {0}, 1}};  // may still turn about the node
  Simulation s(m);
  CHECK(has(said([&] { s.statics({}); }), "block can move as a whole in 1 ways"));
  m.fixed.pop_back();
  Simulation t(m);
  CHECK(has(said([&] { t.statics({}); }), "in 2 ways"));
}

TEST_CASE("Steps above the critical one and unstable methods are refused") {
  Simulation s(good());
  const double step = s.critical_step().by_iteration;
  CHECK(has(said([&] { s.central_difference({.end = 1, .step = 1.01 * step}); }), "above the critical one"));
  CHECK(has(said([&] { s.newmark({.newmark = {.beta = 0.1, .gamma = 0.5}}); }), "gamma of at least 1/2"));
  CHECK(has(said([&] { s.newmark({.newmark = {.beta = 0.5, .gamma = 0.4}}); }), "gamma of at least 1/2"));
  CHECK(has(said([] { hht(-0.5); }), "alpha is -0.5; allowed is -1/3 to 0"));
  CHECK(has(said([&] { s.statics({.step = 0}); }), "step is 0 s"));
  Model light = good();
  light.body[0].material.density = 0;
  Simulation w(light);
  CHECK(has(said([&] { w.newmark({}); }), "block has no density"));
}

TEST_CASE("Meshes of Gmsh are read, with the groups of their boundary") {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_elastic_good.msh";
  write_file_atomically(path, kSquare);
  const Mesh mesh = read_gmsh(path, 0.5);
  std::filesystem::remove(path);
  CHECK(mesh.kind == ElementKind::t3);
  REQUIRE(mesh.node.size() == 4);
  CHECK(mesh.element.size() == 2);
  CHECK(box_of(mesh).high.x == 0.5);
  REQUIRE(mesh.group.count("bottom side") == 1);
  REQUIRE(mesh.group.at("bottom side").size() == 1);
  for (const Index n : nodes_of(mesh.group.at("bottom side"))) CHECK(mesh.node[std::size_t(n)].y == 0);
}

TEST_CASE("Bad files of Gmsh are refused with their line") {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kSquare;
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(has(read_text(with("4.1 0 8", "2.2 0 8")), ".msh:2: format is 2.2; only 4.1 is read"));
  CHECK(has(read_text(with("4.1 0 8", "4.1 1 8")), "the file is binary"));
  CHECK(has(read_text(with("2 1 2 2\n", "2 1 9 2\n")), "elements of type 9 are not read"));
  CHECK(has(read_text(with("3 1 11 12", "3 1 11 13")), "names node 13, which is missing"));
  CHECK(has(read_text(with("2 1 2 11", "2 2 1 11")), "is inverted"));
  CHECK(has(read_text(with("0 1 0\n$EndNodes", "0 one 0\n$EndNodes")), "should be at least 3 numbers"));
  CHECK(
      has(read_text(std::string(kSquare).substr(0, std::string(kSquare).find("2 1 0 4"))), "the file ends too early"));
  CHECK(has(read_text("solid\n"), "should be $MeshFormat"));
  CHECK(has(said([] { read_gmsh("no_such.msh"); }), "no_such.msh"));
}

TEST_CASE("VTK files hold every node and element") {
  const Simulation s(good());
  const std::string text = vtu_bytes(s, 0);
  CHECK(has(text, "NumberOfPoints=\"9\" NumberOfCells=\"4\""));
  CHECK(has(text, "Name=\"displacement\""));
  CHECK(has(text, "Name=\"stress\""));
  CHECK(text == vtu_bytes(Simulation(good()), 0));
}
