// What is simulated: elastic bodies, what holds and loads them, what they touch. Small strains, so that rotations must
// stay small too; contact follows the displaced surfaces, so that bodies may slide by any way.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "sim/elastic/law.h"
#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {

struct Material {
  double young = 0;    // [Pa]
  double poisson = 0;  // [-], above -1 and below 0.5
  double density = 0;  // [kg/m^3]; statics without gravity do not need it
};

/// Of a 2-D mesh. Axisymmetric: about the axis x = 0; forces and masses are those of the whole turn.
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

}  // namespace gonogo::sim::elastic
