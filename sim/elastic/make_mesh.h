// Structured meshes, graded where wanted.
#pragma once
#include <functional>
#include <vector>

#include "sim/elastic/mesh.h"

namespace gonogo::sim::elastic {

/// `count` equal steps from `from` to `to`: count + 1 places. Throws InputError unless from < to and count >= 1.
std::vector<double> even(double from, double to, int count);
/// Equal steps of `first` up to `fine_until`, then steps that grow by `ratio` (above 1, at most 3) up to `to`.
/// Throws InputError for other numbers.
std::vector<double> graded(double from, double fine_until, double to, double first, double ratio);
/// The same places mirrored at the origin, in ascending order.
std::vector<double> mirrored(const std::vector<double>& places);

/// Rectangle with nodes at every pair of places; t3 halves each quadrilateral, along alternating diagonals.
Mesh make_rectangle(const std::vector<double>& x, const std::vector<double>& y, ElementKind kind = ElementKind::q4);
/// Box; t4 cuts each hexahedron into six tetrahedra (Kuhn).
Mesh make_box(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
              ElementKind kind = ElementKind::h8);
/// Sector of a ring between radii [m], first at least above 0, and angles [rad] counter-clockwise from x.
Mesh make_ring_sector(const std::vector<double>& radius, const std::vector<double>& angle,
                      ElementKind kind = ElementKind::q4);
/// Sector of a hollow cylinder about z.
Mesh make_cylinder_sector(const std::vector<double>& radius, const std::vector<double>& angle,
                          const std::vector<double>& z, ElementKind kind = ElementKind::h8);
/// Quarter of a disc about the origin, x >= 0 and y <= 0. `across` and `up` are places in a square that is bent onto
/// the disc: across in [0, 1] from the axis, up in [-1, 0] from the arc. Elliptical grid mapping (Nowell; Fong 2015):
/// x = R u sqrt(1 - v^2 / 2), y = R v sqrt(1 - u^2 / 2); the arc's lower half is v = -1.
Mesh make_quarter_disc(double radius, const std::vector<double>& across, const std::vector<double>& up);

/// The mesh with every node moved. Faces of groups stay.
Mesh moved(Mesh mesh, const std::function<Vec3d(const Vec3d&)>& to);

}  // namespace gonogo::sim::elastic
