// The baseline that adds impulses up by segmented scans: its scan against plain sums, its steps against `jacobi`.
#include "sim/scene/scene.h"
#include "sim/solver/segmented_scan.h"
#include "tests/sim/dense_problem.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

struct KeyOf {
  View<const Index> key;
  GONOGO_HD Index operator()(Index slot) const { return key[slot]; }
};

/// Grains of two layers under two plates, each of which touches a hundred of them; a motor turns a disc on the second.
/// `lift`: of the plates [m].
SceneWorld plates_on_grains(double lift) {
  constexpr double r = 0.02, pitch = 2.02 * r;
  Draw draw(91);
  SceneWorld w = open_world({Real(0.5), Real(0.1), 200});
  add_plane(w);
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 10; ++y)
      for (int z = 0; z < 2; ++z)
        w.add_sphere(Vec3d{x * pitch, y * pitch, r + 1.98 * r * z} + draw.direction() * 1e-4, Real(r), 2600, 0);
  BodyIndex plate = 0;
  for (const int side : {0, 1})
    plate = add_box(w, {{(4.5 + 10 * side) * pitch, 4.5 * pitch, 3.97 * r + 0.0201 + lift}, {}, {}, {}},
                    {0.195f, 0.195f, 0.02f}, 20 + 60 * side, 0);
  w.body[plate].velocity = {Real(0.3), Real(0.1), Real(-0.1)};
  const Vec3d on_top = w.body[plate].position + Vec3d{0, 0, 0.1};
  const BodyIndex disc = w.add_body({on_top, {}, {}, {}}, solid(2, {0.02f, 0.02f, 0.04f}));
  w.joint.push_back(revolute(w, disc, plate, on_top, {0, 0, 1}));
  w.motor.push_back(speed_motor(w.joint.back(), 10, 5));
  return w;
}

StepSettings settings_of(Iteration iteration, Target target, Index substeps, Index iterations) {
  StepSettings s = settings_with(iterations);
  s.iteration = iteration;
  s.target = target;
  s.substeps = substeps;
  return s;
}

double largest(const std::vector<Impulse>& p) {
  double max = 0;
  for (const Impulse& i : p) max = std::max(max, length(static_cast<Vec3d>(i.linear)));
  return max;
}

void check_impulses(const std::vector<Impulse>& a, const std::vector<Impulse>& b, double tolerance) {
  REQUIRE(a.size() == b.size());
  double apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    apart = std::max({apart, length(static_cast<Vec3d>(a[i].linear - b[i].linear)),
                      length(static_cast<Vec3d>(a[i].angular - b[i].angular))});
  INFO(a.size() << " contacts, largest impulse " << largest(a) << " N s, furthest apart " << apart << " N s");
  CHECK(largest(a) > 0);
  CHECK(apart < tolerance * largest(a));
}

/// Columns of spheres that slide and fall onto each other, the highest ones heavier. Each sphere adds one contact, so
/// the impulses are unique.
SceneWorld columns(std::uint64_t seed) {
  Draw draw(seed);
  SceneWorld w = open_world({Real(0.4), 0, 0});
  add_plane(w);
  for (int column = 0; column < 5; ++column)
    for (int k = 0; k < 5; ++k) {
      const BodyIndex b = w.add_sphere({0.5 * column, 0, 0.1 + 0.2 * k}, 0.1f, k == 4 ? 20000 : 2600, 0);
      w.body[b].velocity = static_cast<Vec3>(draw.direction() * 0.3);
      w.body[b].angular_velocity = static_cast<Vec3>(draw.direction() * 3.0);
    }
  return w;
}

/// Of the oracle, in the world frame on body a.
std::vector<Impulse> linear_impulses(const DenseProblem& problem, const DenseSolution& solution,
                                     const std::vector<Contact>& contacts) {
  std::vector<Impulse> result;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (Eigen::Index row = Eigen::Index(5 * i); row < Eigen::Index(5 * i + 3); ++row)
      p += solution.impulse(row) * problem.direction.col(row).segment<3>(6 * contacts[i].body_a);
    result.push_back({{Real(p.x()), Real(p.y()), Real(p.z())}, 0, {}, 0});
  }
  return result;
}

}  // namespace

TEST_CASE("a segmented scan in runs adds up segments of any length") {
  Draw draw(17);
  std::vector<Index> begin{0}, key;
  std::vector<std::int64_t> value;
  for (Index segment = 0; segment < 400; ++segment) {
    const Index lengths[] = {0, 1, kScanRun - 1, kScanRun, kScanRun + 1, 7, Index(draw.magnitude(1, 900))};
    const Index length = lengths[std::size_t(draw.between(0, 6.999))];
    for (Index k = 0; k < length; ++k) {
      key.push_back(segment);
      value.push_back(std::int64_t(draw.between(-1e6, 1e6)));
    }
    begin.push_back(Index(value.size()));
  }
  const std::vector<std::int64_t> given = value;
  const Index slots = Index(given.size()), room = slots + 100;
  key.resize(std::size_t(room), 399);
  value.resize(std::size_t(room), 12345);
  const ScanRun<std::int64_t, KeyOf> scan{{{key.data(), room}}, {value.data(), room}, &slots};
  for_each_index(Cpu{2}, scan_runs(room), scan);
  Index longest = 0, empty = 0;
  for (std::size_t s = 0; s + 1 < begin.size(); ++s) {
    std::int64_t sum = 0;
    for (Index i = begin[s]; i < begin[s + 1]; ++i) {
      const std::int64_t in_run = i % kScanRun == 0 ? 0 : i > begin[s] ? value[std::size_t(i) - 1] : 0;
      CHECK(value[std::size_t(i)] == in_run + given[std::size_t(i)]);
      sum += given[std::size_t(i)];
    }
    CHECK(segment_sum(View<const std::int64_t>{value.data(), room}, begin[s], begin[s + 1]) == sum);
    longest = std::max(longest, begin[s + 1] - begin[s]);
    empty += begin[s] == begin[s + 1];
  }
  CHECK(longest > 10 * kScanRun);
  CHECK(empty > 10);
  CHECK(value.back() == 12345);  // nothing beyond the slots
}

TEST_CASE("jacobi_scan takes the steps of jacobi") {
  const SceneWorld w = plates_on_grains(0);
  for (const Backend backend : backends())
    for (const Target target : {Target::ccp, Target::coulomb})
      for (const Index substeps : {1, 3})
        for (const Index iterations : {1, 6, 40}) {
          const auto fast = simulate(backend, w, settings_of(Iteration::jacobi, target, substeps, iterations));
          const auto scanned = simulate(backend, w, settings_of(Iteration::jacobi_scan, target, substeps, iterations));
          fast->advance(2);  // the second starts warm
          scanned->advance(2);
          INFO(name_of(backend) << ", target " << int(target) << ", " << substeps << " substeps of " << iterations);
          CHECK(scanned->report(0).iterations == substeps * iterations);
          CHECK(scanned->report(0).contact_count == fast->report(0).contact_count);
          // Sums in another order. Rounding of 6e-8 in velocities whose parts cancel; friction may amplify it.
          check_impulses(fast->impulses(0), scanned->impulses(0), 2e-5);
          CHECK(scanned->report(0).rms_residual == Approx(fast->report(0).rms_residual).epsilon(1e-3));
          CHECK(scanned->report(0).max_residual == Approx(fast->report(0).max_residual).epsilon(1e-2));
          CHECK(scanned->report(0).kinetic_energy == Approx(fast->report(0).kinetic_energy).epsilon(1e-5));
          CHECK(scanned->report(0).gravity_power == Approx(fast->report(0).gravity_power).epsilon(1e-4).margin(1e-3));
          CHECK(scanned->motor_torque(0, 0) == Approx(fast->motor_torque(0, 0)).epsilon(1e-4).margin(1e-4));
        }
}

TEST_CASE("jacobi_scan converges to the impulses of a dense solution and to those of jacobi") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SceneWorld w = columns(seed);
    for (const Backend backend : backends()) {
      const auto fast = simulate(backend, w, settings_of(Iteration::jacobi, Target::ccp, 1, 20000));
      const auto scanned = simulate(backend, w, settings_of(Iteration::jacobi_scan, Target::ccp, 1, 20000));
      fast->advance(1);
      scanned->advance(1);
      const auto contacts = scanned->contacts(0);
      const DenseProblem problem = dense_problem(w, w.body, contacts, scanned->settings().step);
      const DenseSolution oracle = solve(problem, 1e-10, 40000);
      REQUIRE(oracle.residual < 1e-9);
      INFO(name_of(backend) << ", seed " << seed);
      CHECK(contacts.size() == 25);
      check_impulses(linear_impulses(problem, oracle, contacts), scanned->impulses(0), 1e-5);
      check_impulses(fast->impulses(0), scanned->impulses(0), 1e-5);
    }
  }
}

TEST_CASE("jacobi_scan stops where jacobi does, and worlds that have ended leave the others alone") {
  for (const Backend backend : backends()) {
    StepSettings settings = settings_of(Iteration::jacobi_scan, Target::coulomb, 2, 300), plain = settings;
    plain.iteration = Iteration::jacobi;
    settings.tolerance = plain.tolerance = 1e-3f;
    const SceneWorld hard = plates_on_grains(0), easy = plates_on_grains(0.1);
    const auto together = make_simulation(backend, {easy, hard, easy}, settings, 2);
    const auto fast = make_simulation(backend, {easy, hard, easy}, plain, 2);
    const auto alone = simulate(backend, hard, settings);
    for (Simulation* s : {together.get(), fast.get(), alone.get()}) s->advance(3);
    INFO(name_of(backend) << ", iterations of the easy world " << together->report(0).iterations << ", of the hard one "
                          << together->report(1).iterations);
    CHECK(together->report(0).iterations < together->report(1).iterations);
    CHECK(together->report(1).iterations < 600);
    CHECK(together->report(1).rms_residual < 2e-3);
    for (WorldIndex world : {0, 1, 2}) CHECK(together->report(world).iterations == fast->report(world).iterations);
    CHECK(same_bits(together->bodies(1), alone->bodies(0)));
    CHECK(same_bits(together->bodies(0), together->bodies(2)));
    CHECK(together->report(1).rms_residual == alone->report(0).rms_residual);
  }
}
