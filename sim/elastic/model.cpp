#include "sim/elastic/model.h"

#include <Eigen/Dense>
#include <cmath>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::sim::elastic {
namespace {

void check_exponent(double m, const char* name, int dimension, const std::string& contact) {
  const double most = dimension == 3 ? 3 : 1e3;
  if (m >= 1 && m <= most) return;
  throw InputError(contact + line(": exponent %s is %g; allowed is ", name, m) +
                   (dimension == 3 ? "1 to 3 in 3-D" : "1 and above in 2-D") +
                   "; 1 is a penalty, 2.5 a rough surface of evenly spread tips");
}

}  // namespace

void check_law(const ContactLaw& law, int dimension, const std::string& contact) {
  if (!(law.c_n > 0) || !std::isfinite(law.c_n))
    throw InputError(contact + line(": stiffness c_n is %g Pa/m^m_n; it must be above 0", law.c_n));
  if (!(law.c_t >= 0) || !std::isfinite(law.c_t))
    throw InputError(contact + line(": friction c_t is %g Pa/m^m_t; it must be 0 or above", law.c_t));
  check_exponent(law.m_n, "m_n", dimension, contact);
  check_exponent(law.m_t, "m_t", dimension, contact);
  if (law.c_t > 0 && !(law.epsilon > 0))
    throw InputError(contact + line(": epsilon is %g m/s; with friction it must be above 0, as 1e-4", law.epsilon));
}

ContactLaw penalty_law(double c_n, double friction, double epsilon) {
  return {.c_n = c_n, .m_n = 1, .c_t = friction * c_n, .m_t = 1, .epsilon = epsilon};
}

ContactLaw rough_law(const RoughSurface& s, double epsilon) {
  if (!(s.density > 0 && s.radius > 0 && s.height > 0 && s.modulus > 0 && s.friction >= 0))
    throw InputError(
        line("rough surface: density %g 1/m^2, radius %g m, height %g m and modulus %g Pa must be above 0, ", s.density,
             s.radius, s.height, s.modulus) +
        line("friction %g must be 0 or above", s.friction));
  const double c_n = 8.0 / 15 * s.modulus * std::sqrt(s.radius) * s.density / s.height;
  return {.c_n = c_n, .m_n = 2.5, .c_t = s.friction * c_n, .m_t = 2.5, .epsilon = epsilon};
}

double psi(double s, double epsilon) {
  return s < epsilon ? s * s / epsilon * (1 - s / (3 * epsilon)) : s - epsilon / 3;
}

double psi_slope(double s, double epsilon) { return s < epsilon ? (2 - s / epsilon) * s / epsilon : 1; }

double psi_curvature(double s, double epsilon) { return s < epsilon ? 2 * (1 - s / epsilon) / epsilon : 0; }

namespace {

void check_body(const Body& b, int dimension) {
  check_mesh(b.mesh, b.name);
  const Material& m = b.material;
  if (dimension_of(b.mesh.kind) != dimension)
    throw InputError(b.name + ": 2-D and 3-D bodies cannot meet; mesh all in one dimension");
  if (!(m.young > 0) || !std::isfinite(m.young))
    throw InputError(b.name + line(": Young's modulus is %g Pa; it must be above 0", m.young));
  if (!(m.poisson > -1 && m.poisson < 0.5))
    throw InputError(b.name +
                     line(": Poisson's ratio is %g; it must be above -1 and below 0.5, as 0.49 for rubber", m.poisson));
  if (!(m.density >= 0)) throw InputError(b.name + line(": density is %g kg/m^3; it must be 0 or above", m.density));
  if (!(b.thickness > 0)) throw InputError(b.name + line(": thickness is %g m; it must be above 0", b.thickness));
  if (dimension == 2 && b.plane == Plane::axisymmetric)
    for (const Vec3d& x : b.mesh.node)
      if (x.x < 0)
        throw InputError(b.name + line(": a node has radius %g m; axisymmetric meshes need x of 0 or above", x.x));
}

void check_index(int body, const Model& model, const std::string& what) {
  if (body < 0 || std::size_t(body) >= model.body.size())
    throw InputError(what + " names body " + std::to_string(body) + "; bodies are 0 to " +
                     std::to_string(model.body.size() - 1));
}

void check_nodes(const std::vector<Index>& nodes, const Body& b, const std::string& what) {
  if (nodes.empty()) throw InputError(what + " of " + b.name + " has no node; select at least one");
  for (const Index n : nodes)
    if (n < 0 || std::size_t(n) >= b.mesh.node.size())
      throw InputError(what + " of " + b.name + " names node " + std::to_string(n) + "; nodes are 0 to " +
                       std::to_string(b.mesh.node.size() - 1));
}

void check_contact(const Contact& c, const Model& model, int dimension) {
  check_index(c.body, model, c.name);
  check_nodes(nodes_of(c.face), model.body[std::size_t(c.body)], c.name);
  check_law(c.law, dimension, c.name);
  if (c.points < 1 || c.points > 5)
    throw InputError(c.name + ": " + std::to_string(c.points) + " Gauss points; allowed are 1 to 5");
  if (c.other >= 0) {
    check_index(c.other, model, c.name);
    check_nodes(nodes_of(c.other_face), model.body[std::size_t(c.other)], c.name);
    if (c.reach < 0) throw InputError(c.name + line(": reach is %g m; it must be 0 or above", c.reach));
    return;
  }
  const RigidShape& s = c.shape;
  if (s.kind != RigidKind::half_space && !(s.radius > 0))
    throw InputError(c.name + line(": radius of the rigid shape is %g m; it must be above 0", s.radius));
  if (s.kind != RigidKind::ball && std::fabs(length(s.axis) - 1) > 1e-9)
    throw InputError(c.name + line(": axis of the rigid shape has length %g; it must be 1", length(s.axis)));
  if (s.kind == RigidKind::cylinder && dimension == 2)
    throw InputError(c.name + ": a cylinder in 2-D is a ball; use that");
}

/// Displacement of a node by one of the motions of a whole body: translations, then rotations about its centre.
Vec3d rigid_motion(int mode, int dimension, bool axisymmetric, const Vec3d& x) {
  if (axisymmetric) return {0, 1, 0};
  if (mode < dimension) return {mode == 0 ? 1.0 : 0.0, mode == 1 ? 1.0 : 0.0, mode == 2 ? 1.0 : 0.0};
  const int axis = dimension == 2 ? 2 : mode - 3;
  return cross(Vec3d{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}, x);
}

/// Number of independent motions that the fixed displacements leave.
int free_motions(const Model& model, int body) {
  const Body& b = model.body[std::size_t(body)];
  const int d = dimension_of(b.mesh.kind);
  const bool axisymmetric = d == 2 && b.plane == Plane::axisymmetric;
  const int modes = axisymmetric ? 1 : d == 2 ? 3 : 6;
  const Box box = box_of(b.mesh);
  const Vec3d centre = (box.low + box.high) * 0.5;
  const double size = length(box.high - box.low);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(modes, modes);
  for (const Fixed& f : model.fixed)
    if (f.body == body)
      for (const Index n : f.node) {
        Eigen::VectorXd row(modes);
        for (int m = 0; m < modes; ++m) {
          const Vec3d v = rigid_motion(m, d, axisymmetric, (b.mesh.node[std::size_t(n)] - centre) * (1 / size));
          row[m] = f.component == 0 ? v.x : f.component == 1 ? v.y : v.z;
        }
        gram += row * row.transpose();
      }
  const Eigen::VectorXd held = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues();
  return int((held.array() < 1e-8).count());
}

}  // namespace

void check_model(const Model& model) {
  if (model.body.empty()) throw InputError("the model has no body; give at least one");
  const int dimension = dimension_of(model.body[0].mesh.kind);
  for (const Body& b : model.body) check_body(b, dimension);
  for (const Fixed& f : model.fixed) {
    check_index(f.body, model, "a fixed displacement");
    const Body& b = model.body[std::size_t(f.body)];
    check_nodes(f.node, b, "a fixed displacement");
    if (f.component < 0 || f.component >= dimension)
      throw InputError("a fixed displacement of " + b.name + " names component " + std::to_string(f.component) +
                       "; components are 0 to " + std::to_string(dimension - 1));
  }
  for (const Traction& t : model.traction) {
    check_index(t.body, model, "a traction");
    check_nodes(nodes_of(t.face), model.body[std::size_t(t.body)], "a traction");
  }
  for (const Contact& c : model.contact) check_contact(c, model, dimension);
}

void check_held(const Model& model) {
  for (std::size_t i = 0; i < model.body.size(); ++i) {
    bool touches = false;
    for (const Contact& c : model.contact) touches = touches || c.body == int(i) || c.other == int(i);
    const int free = free_motions(model, int(i));
    if (touches || free == 0) continue;
    throw InputError(model.body[i].name + " can move as a whole in " + std::to_string(free) +
                     " ways, so that statics have no answer; fix more displacements, add a contact or use dynamics");
  }
}

}  // namespace gonogo::sim::elastic
