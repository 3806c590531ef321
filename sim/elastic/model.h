// What is simulated: elastic bodies, what holds and loads them, what they touch. Small strains, so that rotations must
// stay small too; contact follows the displaced surfaces, so that bodies may slide by any way.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {

// Law of a compliant surface with friction. Normal compliance and friction by powers of the penetration:
//   pressure  p = c_n w^m_n,  w = max(-gap, 0)
//   friction |q| <= c_t w^m_t, against the sliding velocity v; Coulomb with mu = c_t / c_n where m_t = m_n
// Oden & Martins, Models and computational methods for dynamic friction phenomena, CMAME 52, 1985. Friction is
// regularised by the convex function psi with threshold epsilon [m/s] of the same paper:
//   psi(v) = v^2 / epsilon (1 - |v| / (3 epsilon)) for |v| < epsilon, |v| - epsilon / 3 from there on
//   q = -c_t w^m_t psi'(|v|) v / |v|,  psi'(s) = (2 - s / epsilon) s / epsilon, then 1
// psi' is piecewise quadratic and has a continuous slope: 2 / epsilon at rest, 0 at the threshold. Full sliding is
// exact above the threshold; below it the surface creeps in place of sticking.

struct ContactLaw {
  double c_n = 0;         // [Pa/m^m_n]
  double m_n = 1;         // [-]
  double c_t = 0;         // [Pa/m^m_t]; 0: no friction
  double m_t = 1;         // [-]
  double epsilon = 1e-4;  // [m/s]
};

/// Throws InputError, naming `contact`, for c_n not above 0, c_t below 0, exponents outside 1 to 3 (2-D: below 1;
/// Martins & Oden 1987 need that bound for a solution to exist) and an epsilon not above 0 where there is friction.
void check_law(const ContactLaw& law, int dimension, const std::string& contact);

/// Penalty: linear, with Coulomb's coefficient. c_n [Pa/m].
ContactLaw penalty_law(double c_n, double friction, double epsilon);

/// A rough surface: hemispherical tips of one radius, with heights spread evenly.
struct RoughSurface {
  double density = 0;   // tips per area [1/m^2]
  double radius = 0;    // of the tips [m]
  double height = 0;    // of the highest tip above the lowest [m]
  double modulus = 0;   // E* of the pair, 1 / E* = (1 - nu_1^2) / E_1 + (1 - nu_2^2) / E_2 [Pa]
  double friction = 0;  // [-]
};
/// Greenwood & Williamson, Contact of nominally flat surfaces, 1966, with an even distribution in place of the Gaussian
/// one, where the integral has a closed form: p = (4/3) E* sqrt(R) (density / height) integral_0^w s^(3/2) ds, so that
/// m_n = 5/2 and c_n = (8/15) E* sqrt(R) density / height. Holds for penetrations up to `height`. Throws InputError for
/// numbers not above 0, friction below 0.
ContactLaw rough_law(const RoughSurface& surface, double epsilon);

/// psi and its first two derivatives at the speed s >= 0 [m/s].
double psi(double s, double epsilon);
double psi_slope(double s, double epsilon);
double psi_curvature(double s, double epsilon);

struct Material {
  double young = 0;    // [Pa]
  double poisson = 0;  // [-], above -1 and below 0.5
  double density = 0;  // [kg/m^3]; statics without gravity do not need it
};

/// How a 2-D mesh is meant. Axisymmetric: about the axis x = 0; forces and masses are those of the whole turn.
enum class Plane { strain, stress, axisymmetric };

struct Body {
  std::string name;
  Mesh mesh;
  Material material;
  Plane plane = Plane::strain;
  double thickness = 1;  // [m], of plane strain and stress
};

using OverTime = std::function<double(double)>;       // of the time [s]
using VectorOverTime = std::function<Vec3d(double)>;  // of the time [s]

/// A component of the displacement is given (Dirichlet).
struct Fixed {
  int body = 0;
  std::vector<Index> node;
  int component = 0;                                   // 0, 1, 2: x, y, z
  OverTime displacement = [](double) { return 0.0; };  // [m]
};

/// Force per area of the undeformed surface (Neumann) [Pa].
struct Traction {
  int body = 0;
  std::vector<Face> face;
  VectorOverTime traction;
};

enum class RigidKind {
  half_space,  // below the plane through `point`, normal `axis`
  ball,        // about `point`; in 2-D a cylinder across the plane
  cylinder     // 3-D, about the line through `point` along `axis`
};

/// An obstacle that moves as it is told.
struct RigidShape {
  RigidKind kind = RigidKind::half_space;
  Vec3d point{}, axis{0, 1, 0};
  double radius = 0;                                             // [m]
  VectorOverTime displacement = [](double) { return Vec3d{}; };  // [m]
};

/// Surface of a body that may touch a rigid shape or another body. Forces are integrated over `face`, at `points` Gauss
/// points in each direction, by projecting them onto the other surface.
struct Contact {
  std::string name = "contact";
  int body = 0;
  std::vector<Face> face;
  int other = -1;  // body; -1: the rigid shape
  std::vector<Face> other_face{};
  RigidShape shape{};
  ContactLaw law{};
  int points = 2;    // 1 to 5
  double reach = 0;  // deepest penetration looked for between bodies [m]; 0: the size of the largest other face
};

struct Model {
  std::vector<Body> body;
  std::vector<Fixed> fixed{};
  std::vector<Traction> traction{};
  std::vector<Contact> contact{};
  Vec3d gravity{};  // [m/s^2]
};

/// Throws InputError for a model that cannot be computed: see check_mesh, check_law; materials and indices out of
/// range; bodies of both dimensions; an axisymmetric node at a radius below 0.
void check_model(const Model& model);
/// Throws InputError for a body that neither fixed displacements nor a contact keep from moving as a whole.
void check_held(const Model& model);

enum class Touch { open, stick, slip };  // stick: slower than epsilon

struct ContactPoint {
  int contact = 0;  // of the model
  Touch touch = Touch::open;
  Vec3d place{};        // of the displaced surface [m]
  Vec3d normal{};       // out of the obstacle or of the other body
  double gap = 0;       // [m]; open points of two bodies without a face opposite: infinity
  double area = 0;      // its share of the undeformed surface; in 2-D times the thickness or the turn [m^2]
  double pressure = 0;  // [Pa]
  Vec3d shear{};        // friction on `body` [Pa]
  Vec3d sliding{};      // tangential velocity of `body` over the other [m/s]
};

}  // namespace gonogo::sim::elastic
