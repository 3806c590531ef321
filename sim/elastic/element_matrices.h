// Matrices of one element. Internal: Eigen.
#pragma once
#include <Eigen/Dense>

#include "sim/elastic/model.h"
#include "sim/elastic/shape_functions.h"

namespace gonogo::sim::elastic {

using ElementMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 24, 24>;
using StrainMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 24>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Stress from strain, both as xx, yy, zz, xy, yz, zx with engineering shear; Hughes, section 2.7. Plane stress: zz is
/// 0.
Matrix6 elasticity(const Material& material, bool plane_stress);
/// Strain from the corners' displacements. `radius` above 0: hoop strain u_x / radius.
StrainMatrix strain_matrix(int corners, int dimension, const Gradient& gradient, const ShapeValues& values,
                           double radius);
/// Volume that a quadrature point stands for [m^3], and its radius where the body is axisymmetric, else 0.
struct PointVolume {
  double volume = 0, radius = 0;
};
PointVolume volume_at(const Body& body, std::size_t element, const QuadraturePoint& q, const ShapeValues& values,
                      const Gradient& gradient);

ElementMatrix stiffness_of(const Body& body, std::size_t element);        // [N/m]
ElementMatrix consistent_mass_of(const Body& body, std::size_t element);  // [kg]
/// Row sums of the consistent mass, one per corner [kg].
Eigen::VectorXd lumped_mass_of(const Body& body, std::size_t element);

}  // namespace gonogo::sim::elastic
