#include "base/math/vec.h"

#include <Eigen/Geometry>

#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using gonogo::test::Draw;

namespace {

Eigen::Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Eigen::Matrix3d matrix(const Quat& q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix(); }
Eigen::Matrix3d matrix(const SymMat3& m) {
  Eigen::Matrix3d r;
  r << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return r;
}
Vec3 random_vector(Draw& draw) { return static_cast<Vec3>(draw.direction() * draw.magnitude(1e-2, 1e2)); }

// Ten or so single-precision operations of 6e-8 each.
constexpr double kRelative = 1e-6;

}  // namespace

TEST_CASE("rotations agree with Eigen's matrices") {
  Draw draw(1);
  for (int i = 0; i < 1000; ++i) {
    const Quat q = normalised(draw.orientation()), p = normalised(draw.orientation());
    const Vec3 v = random_vector(draw);
    const double size = eigen(v).norm();
    REQUIRE((eigen(rotate(q, v)) - matrix(q) * eigen(v)).norm() <= kRelative * size);
    REQUIRE((eigen(rotate_back(q, v)) - matrix(q).transpose() * eigen(v)).norm() <= kRelative * size);
    REQUIRE((matrix(normalised(q * p)) - matrix(q) * matrix(p)).norm() <= 4 * kRelative);
    const Vec3 d{Real(draw.unit()), Real(draw.unit()), Real(draw.unit())};
    const Eigen::Matrix3d expected = matrix(q) * eigen(d).asDiagonal() * matrix(q).transpose();
    REQUIRE((matrix(rotated_diagonal(q, d)) - expected).norm() <= 4 * kRelative);
    REQUIRE((eigen(rotated_diagonal(q, d) * v) - expected * eigen(v)).norm() <= 4 * kRelative * size);
  }
}

TEST_CASE("turning in small steps ends at the closed-form orientation") {
  Draw draw(2);
  for (int i = 0; i < 20; ++i) {
    const Quat start = draw.orientation();
    const Vec3 rate = static_cast<Vec3>(draw.direction() * 5.0);
    Quat q = start;
    for (int k = 0; k < 1000; ++k) q = turned(q, rate, Real(1e-3));
    const Eigen::Matrix3d expected =
        Eigen::AngleAxisd(eigen(rate).norm(), eigen(rate).normalized()).toRotationMatrix() * matrix(start);
    // Each step turns by 2 atan(w h / 2) instead of w h: 1 s at 5 rad/s loses 1000 (5e-3)^3 / 12 = 1e-5 rad; rounding
    // of 1000 products adds 1000 x 6e-8.
    INFO("error " << (matrix(q) - expected).norm());
    REQUIRE((matrix(q) - expected).norm() < 1e-4);
  }
}

TEST_CASE("cross products are perpendicular and double keeps a micrometre a kilometre away") {
  Draw draw(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = random_vector(draw), b = random_vector(draw);
    const Eigen::Vector3d expected = eigen(a).cross(eigen(b));
    REQUIRE((eigen(cross(a, b)) - expected).norm() <= kRelative * eigen(a).norm() * eigen(b).norm());
  }
  const Vec3d far{1000, 1000, 1000}, near{1000 + 1e-6, 1000, 1000};
  CHECK(static_cast<Vec3>(near - far).x == Approx(1e-6).epsilon(1e-6));
}
