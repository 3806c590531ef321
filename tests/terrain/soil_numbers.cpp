// What is derived from soil tests, on made-up measurements of known soils.
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "base/units.h"
#include "sim/shape/triangle_mesh.h"
#include "terrain/soil/soil.h"
#include "terrain/soil_test/penetration.h"
#include "terrain/soil_test/strength_test.h"
#include "tests/support/catch.h"

namespace gonogo::terrain {
namespace {

PlateResult bekker_plate(double width, double k_c, double k_phi, double n) {
  PlateResult r;
  r.width = width;
  for (int i = 1; i <= 50; ++i) {
    const double z = 0.002 * i;
    r.curve.push_back({z, (k_c / width + k_phi) * std::pow(z, n)});
  }
  return r;
}

/// Mohr-Coulomb: s1 = s3 (1 + sin) / (1 - sin) + 2 c cos / (1 - sin).
TriaxialResult failed_at(double lateral, double phi_deg, double c) {
  const double s = std::sin(phi_deg * kDegree), k = std::cos(phi_deg * kDegree);
  TriaxialResult r;
  r.steady_lateral = r.peak_lateral = lateral;
  r.steady_axial = r.peak_axial = (lateral * (1 + s) + 2 * c * k) / (1 - s);
  return r;
}

}  // namespace

TEST_CASE("the fitted line is the one that the points lie on, and weights of zero take points away") {
  const LineFit f = fit_line({0, 1, 2, 3}, {2, 5, 8, 100}, {1, 1, 1, 0});
  CHECK(f.intercept == Approx(2).margin(1e-9));
  CHECK(f.slope == Approx(3).epsilon(1e-9));
  CHECK(f.r2 == Approx(1));
  CHECK(f.slope_error == Approx(0).margin(1e-6));
}

TEST_CASE("standard errors of a line are the scatter of lines through repeated measurements") {
  // Uniform noise of +-1 has the standard deviation 1 / sqrt(3).
  double slope_square = 0, intercept_square = 0, slope_error = 0, intercept_error = 0;
  constexpr int repeats = 2000;
  for (int k = 0; k < repeats; ++k) {
    std::vector<double> x, y;
    for (int i = 0; i < 8; ++i) {
      x.push_back(i);
      y.push_back(1 + 0.5 * i + 2 * random_unit(5, std::uint64_t(k), std::uint64_t(i)) - 1);
    }
    const LineFit f = fit_line(x, y);
    slope_square += (f.slope - 0.5) * (f.slope - 0.5) / repeats;
    intercept_square += (f.intercept - 1) * (f.intercept - 1) / repeats;
    slope_error += f.slope_error * f.slope_error / repeats;
    intercept_error += f.intercept_error * f.intercept_error / repeats;
  }
  CHECK(slope_error == Approx(slope_square).epsilon(0.1));
  CHECK(intercept_error == Approx(intercept_square).epsilon(0.1));
}

TEST_CASE("plates pressed into a Bekker soil give its numbers back, from two widths and from three") {
  const double k_c = 5.27e3, k_phi = 1515e3, n = 0.7;  // sandy loam, 15 % water (Wong)
  std::vector<PlateResult> plates = {bekker_plate(0.05, k_c, k_phi, n), bekker_plate(0.1, k_c, k_phi, n)};
  for (int count = 2; count <= 3; ++count) {
    const BekkerFit f = fit_bekker(plates);
    CHECK(f.n == Approx(n));
    CHECK(f.k_c == Approx(k_c));
    CHECK(f.k_phi == Approx(k_phi));
    CHECK(f.r2 == Approx(1));
    plates.push_back(bekker_plate(0.3, k_c, k_phi, n));
  }
  CHECK(fit_power_law(plates[0]).k == Approx(k_c / 0.05 + k_phi));
}

TEST_CASE("a plate that breaks into its bed between two loads has no power law") {
  PlateResult r;
  r.width = 0.1;
  r.curve = {{0, 1e3}, {0.001, 2e3}, {0.002, 4e3}, {0.003, 8e3}, {0.4, 16e3}};
  CHECK_THROWS_AS(fit_power_law(r), DeviceError);
  CHECK_THROWS_AS(fit_bekker({r, bekker_plate(0.2, 5e3, 1e6, 0.7)}), DeviceError);
}

TEST_CASE("a Mohr-Coulomb soil gives its friction angle and cohesion back from triaxial and from shear tests") {
  const TriaxialStrength t =
      triaxial_strength({failed_at(5e3, 31, 2e3), failed_at(10e3, 31, 2e3), failed_at(40e3, 31, 2e3)}, true);
  CHECK(t.steady_angle.degrees == Approx(31));
  CHECK(t.steady_cohesion == Approx(2e3));
  CHECK(triaxial_strength({failed_at(5e3, 28, 0)}, false).peak_angle.degrees == Approx(28));
  std::vector<ShearResult> tests;
  for (const double stress : {5e3, 10e3, 20e3}) {
    ShearResult r{};
    r.normal_stress = stress;
    r.shear_stress = 1.5e3 + stress * std::tan(29 * kDegree);
    r.peak_stress = 1.5e3 + stress * std::tan(35 * kDegree);
    tests.push_back(r);
  }
  const ShearStrength s = shear_strength(tests);
  CHECK(s.steady_angle.degrees == Approx(29));
  CHECK(s.peak_angle.degrees == Approx(35));
  CHECK(s.steady_cohesion == Approx(1.5e3));
  CHECK(s.steady_r2 == Approx(1));
  const ShearStrength one = shear_strength({tests[1]});
  CHECK(one.steady_angle.degrees == Approx(std::atan(0.15 + std::tan(29 * kDegree)) / kDegree));
  CHECK(one.steady_cohesion == 0);
}

TEST_CASE("a Mohr-Coulomb fit of specimens that scatter is right in the mean, and its errors are the scatter of fits") {
  // Four specimens each under stresses of 1 to 8 kPa, strengths off by up to 12 per cent either way.
  constexpr int repeats = 2000;
  std::vector<double> angles, cohesions;
  double angle_variance = 0, cohesion_variance = 0;
  for (int k = 0; k < repeats; ++k) {
    std::vector<TriaxialResult> tests;
    for (int i = 0; i < 16; ++i) {
      tests.push_back(failed_at(1e3 * double(1 << i % 4), 32, 1e3));
      tests.back().peak_axial *= 1 + 0.12 * (2 * random_unit(7, std::uint64_t(k), std::uint64_t(i)) - 1);
    }
    const TriaxialStrength s = triaxial_strength(tests, true);
    angles.push_back(s.peak_angle.degrees);
    cohesions.push_back(s.peak_cohesion);
    angle_variance += s.peak_angle.error * s.peak_angle.error / repeats;
    cohesion_variance += s.peak_cohesion_error * s.peak_cohesion_error / repeats;
  }
  const MeanError angle = mean_error(angles), cohesion = mean_error(cohesions);
  CHECK(std::fabs(angle.mean - 32) < 0.05);
  CHECK(std::fabs(cohesion.mean - 1e3) < 10);
  CHECK(std::sqrt(angle_variance) == Approx(angle.error * std::sqrt(double(repeats))).epsilon(0.1));
  CHECK(std::sqrt(cohesion_variance) == Approx(cohesion.error * std::sqrt(double(repeats))).epsilon(0.1));
}

TEST_CASE("the cone is a closed body whose volume is that of a 30 degree cone with a shaft") {
  const double d = 0.1, shaft = 0.2;
  const sim::TriangleMesh mesh = cone_mesh(d, shaft);
  CHECK_NOTHROW(sim::check_mesh(mesh));
  double volume = 0;
  for (const auto& t : mesh.triangle)
    volume += double(dot(mesh.vertex[std::size_t(t[0])],
                         cross(mesh.vertex[std::size_t(t[1])], mesh.vertex[std::size_t(t[2])]))) /
              6;
  // Areas of 24-sided polygons, 0.989 of their circles; cone, frustum of a tenth of the diameter, shaft.
  const double polygon = 12 * std::sin(2 * kPi / 24), r = d / 2, q = 0.783 * r;
  const double height = r / std::tan(15 * kDegree);
  const double expected =
      polygon * (r * r * height / 3 + 0.1 * d * (r * r + r * q + q * q) / 3 + q * q * (shaft - 0.1 * d));
  CHECK(volume == Approx(expected).epsilon(1e-5));
}

TEST_CASE("relative density and settling friction are each other's inverse, denser where slipperier") {
  for (const double density : {0.0, 0.2, 0.463, 0.7, 1.0})
    CHECK(relative_density_of(settle_friction(density)) == Approx(density).margin(1e-12));
  CHECK(settle_friction(0) > settle_friction(0.5));
  CHECK(settle_friction(0.5) > settle_friction(1));
}

TEST_CASE(
    "bearing capacity factors are those of the tables; the cone index of clay is nine times its strength and its "
    "load") {
  CHECK(bearing_capacity_factor(0) == Approx(5.14).epsilon(1e-3));
  CHECK(bearing_capacity_factor(10) == Approx(8.34).epsilon(1e-3));
  CHECK(bearing_capacity_factor(20) == Approx(14.83).epsilon(1e-3));
  CHECK(bearing_capacity_factor(30) == Approx(30.14).epsilon(1e-3));
  CHECK(bearing_capacity_factor(1e-5) == Approx(bearing_capacity_factor(0)).epsilon(1e-5));
  CHECK(surcharge_factor(0) == Approx(1));
  CHECK(surcharge_factor(20) == Approx(6.40).epsilon(1e-3));
  CHECK(surcharge_factor(30) == Approx(18.40).epsilon(1e-3));
  CHECK(cone_index(20e3, 0) == Approx(180e3 + kOverburden));
}

TEST_CASE("clays that Wong measured wet are below the 39 psi of an HMMWV's fifty passes, dry ones far above") {
  const auto psi = [](double cohesion_kPa, double angle) { return cone_index(cohesion_kPa * 1e3, angle) / kPsi; };
  CHECK(psi(13.79, 11) < 39);  // lean clay, 32 % water
  CHECK(psi(20.69, 6) < 39);   // heavy clay, 40 %
  CHECK(psi(3.1, 29.8) < 39);  // Grenville loam, 24 %
  CHECK(psi(6.1, 26.6) > 39);  // North Gower clayey loam, 46 %: 36 psi of cohesion and 4 of the soil above
  CHECK(psi(68.95, 20) > 78);  // lean clay, 22 %
  CHECK(psi(68.95, 34) > 78);  // heavy clay, 25 %
}

TEST_CASE("Janosi's K is that of the curve, with noise within the scatter, whatever lies beyond the limit") {
  const double k = 0.012, limit = 5e3;
  std::vector<double> j, tau, noisy;
  for (int i = 1; i <= 80; ++i) {
    j.push_back(0.0015 * i);
    tau.push_back(limit * (1 - std::exp(-j.back() / k)));
    noisy.push_back(tau.back() + 150 * (2 * random_unit(7, 1, std::uint64_t(i)) - 1));
  }
  CHECK(fit_janosi(j, tau, limit) == Approx(k));
  CHECK(fit_janosi(j, noisy, limit) == Approx(k).epsilon(0.1));
  // What the stress does after it has reached the limit does not count.
  std::vector<double> humped = tau;
  for (std::size_t i = 40; i < humped.size(); ++i) humped[i] = 1.3 * limit;
  CHECK(fit_janosi(j, humped, limit) == Approx(k));
  // Half as stiff a soil has twice the K.
  for (double& x : j) x *= 2;
  CHECK(fit_janosi(j, tau, limit) == Approx(2 * k));
  CHECK_THROWS_AS(fit_janosi({0.001}, {limit}, limit), InputError);
}

}  // namespace gonogo::terrain
