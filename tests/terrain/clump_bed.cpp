// Beds of clumps: packings, their files, what is cut from and made of them, and that tests on them keep their bits.
#include <algorithm>
#include <cmath>

#include "base/files/file.h"
#include "base/math/random.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil_test/strength_test.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::terrain;
using gonogo::test::agrees;

namespace {

BedSpec small_bed(GrainShape shape) {
  BedSpec s;
  s.grain_diameter = 0.1;
  s.shape = shape;
  s.length = s.width = 0.5;
  s.depth = 0.4;
  s.settle_friction = 0.25;
  return s;
}

const Packing& settled(GrainShape shape) {
  static const Packing pair = settle_packing(small_bed(GrainShape::pair), 1),
                       trefoil = settle_packing(small_bed(GrainShape::trefoil), 1);
  return shape == GrainShape::pair ? pair : trefoil;
}

constexpr GrainShape kClumps[] = {GrainShape::pair, GrainShape::trefoil};

/// Share of random points between two heights that lie in a lobe or its periodic images.
double counted_solid_fraction(const Packing& p, double low, double high) {
  const std::vector<Grain> lobes = lobes_of(p);
  constexpr int points = 20000;
  int hits = 0;
  for (int i = 0; i < points; ++i) {
    const auto u = [&](std::uint64_t k) { return random_unit(9, k, std::uint64_t(i)); };
    const Vec3d at{u(0) * p.spec.length, u(1) * p.spec.width, low + u(2) * (high - low)};
    hits += std::any_of(lobes.begin(), lobes.end(), [&](const Grain& g) {
      const double dx = std::remainder(g.position.x - at.x, p.spec.length),
                   dy = std::remainder(g.position.y - at.y, p.spec.width);
      return std::hypot(dx, dy, g.position.z - at.z) < g.radius;
    });
  }
  return double(hits) / points;
}

bool same(const std::vector<Grain>& a, const std::vector<Grain>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Grain& x, const Grain& y) {
    const Quat &p = x.orientation, &q = y.orientation;
    return x.position.x == y.position.x && x.position.y == y.position.y && x.position.z == y.position.z &&
           x.radius == y.radius && p.w == q.w && p.x == q.x && p.y == q.y && p.z == q.z;
  });
}

}  // namespace

TEST_CASE("a packing of clumps is dense, at rest, and its solid fraction counts overlapping lobes once") {
  for (const GrainShape shape : kClumps) {
    const Packing& p = settled(shape);
    const double d = p.spec.grain_diameter;
    CHECK(p.residual_speed < 0.01);
    CHECK(p.surface > 0.3);
    // 20,000 points: a standard error of 0.0035. Lobes were cut by the two heights as if they overlapped evenly.
    CHECK(agrees(name_of(shape) + ": solid fraction", counted_solid_fraction(p, d, p.surface - d), p.solid_fraction,
                 0.015));
    double deepest = 0;
    const std::vector<Grain> lobes = lobes_of(p);
    const std::size_t each = lobes.size() / p.grain.size();
    for (std::size_t i = 0; i < lobes.size(); ++i)
      for (std::size_t j = 0; j < i / each * each; ++j) {
        const Grain &a = lobes[i], &b = lobes[j];
        const double dx = std::remainder(a.position.x - b.position.x, p.spec.length),
                     dy = std::remainder(a.position.y - b.position.y, p.spec.width);
        deepest = std::max(deepest, a.radius + b.radius - std::hypot(dx, dy, a.position.z - b.position.z));
      }
    CHECK(deepest < 0.02 * d);
  }
}

TEST_CASE("a packing of clumps stays where it is, also on a hard layer, side by side and mirrored") {
  for (const GrainShape shape : kClumps) {
    const Packing& p = settled(shape);
    std::uint64_t mirroring = 0;  // a seed whose variation is a mirror image
    while (!(random_unit(mirroring, 5, 2) < 0.5)) ++mirroring;
    for (const Packing& bed : {p, tiled(p, 2, 1), shifted(p, mirroring), on_hard_layer(p, 0.2)}) {
      const sim::PairLaw law{0.5f, 0, 0};
      const auto s =
          test::simulate(sim::Backend::cpu, bed_world(bed, {law, law}, 0.3), bed_step_settings(0.1, 1e-3, 150));
      s->advance(150);
      REQUIRE(s->report(0).flags == 0);
      const auto now = grain_places(s->bodies(0), shape, bed.grain.size());
      double moved = 0, turned = 0;
      for (std::size_t i = 0; i < now.size(); ++i) {
        moved += std::fabs(now[i].position.z - bed.grain[i].position.z) / double(now.size());
        const Quat &a = now[i].orientation, &b = bed.grain[i].orientation;
        const double cosine = std::min(1.0, std::fabs(double(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z)));
        turned += 2 * std::acos(cosine) / double(now.size());
      }
      CHECK(agrees(name_of(shape) + ": mean settlement, in grain diameters", 0, moved / 0.1, 0.01));
      CHECK(agrees(name_of(shape) + ": mean turn [rad]", 0, turned, 0.02));
    }
  }
}

TEST_CASE("a bed of clumps on a hard layer has all lobes of its clumps, loose or glued") {
  const Packing& p = settled(GrainShape::trefoil);
  const Packing bed = on_hard_layer(p, 0.2);
  const double top = p.surface - 0.2;
  std::size_t loose = 0, glued = 0;
  for (const Grain& g : p.grain) g.position.z >= top ? ++loose : ++glued;
  CHECK(bed.grain.size() == loose);
  CHECK(bed.base.size() >= 3 * glued);
  CHECK(bed.base.size() <= 3 * glued + p.base.size());
}

TEST_CASE("clumps that fall on each other have the same bits for 1, 2 and 7 threads") {
  Packing p = settled(GrainShape::trefoil);
  for (Grain& g : p.grain) g.position.z *= 1.3;
  const sim::PairLaw law{0.5f, 0, 0};
  std::vector<std::vector<Grain>> end;
  for (const int threads : {1, 2, 7}) {
    const auto s = sim::make_simulation(sim::Backend::cpu, {bed_world(p, {law, law}, 0.5)},
                                        bed_step_settings(0.1, 1e-3, 20), threads);
    s->advance(150);
    end.push_back(p.grain);
    take_places(end.back(), GrainShape::trefoil, s->bodies(0));
  }
  CHECK(length(end[0].back().position - p.grain.back().position) > 0.01);
  CHECK(same(end[0], end[1]));
  CHECK(same(end[0], end[2]));
}

TEST_CASE("a packing of clumps comes out of its file as it went in") {
  const TemporaryFolder folder;
  const Packing& p = settled(GrainShape::trefoil);
  write_packing(folder / "p.h5", p);
  const Packing read = read_packing(folder / "p.h5");
  CHECK(same(p.grain, read.grain));
  CHECK(same(p.base, read.base));
  CHECK(read.spec.hash() == p.spec.hash());
  CHECK(read.solid_fraction == p.solid_fraction);
  BedSpec spheres = p.spec;
  spheres.shape = GrainShape::sphere;
  CHECK(spheres.hash() != p.spec.hash());
}

TEST_CASE("ground that is renewed gets its clumps back as they lay") {
  const Packing bed = tiled(settled(GrainShape::pair), 4, 1);
  const sim::PairLaw law{0.5f, 0, 0};
  const auto s = test::simulate(sim::Backend::cpu, bed_world(bed, {law, law}, 0.3), bed_step_settings(0.1, 1e-3, 50));
  const auto start = grain_places(s->bodies(0), GrainShape::pair, bed.grain.size());
  const MovingPatch patch{bed.spec.length, 0.5};
  std::vector<sim::BodyIndex> all;
  std::vector<sim::BodyState> thrown = s->bodies(0);
  thrown.resize(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) {
    all.push_back(sim::BodyIndex(i));
    thrown[i].orientation = {0, 1, 0, 0};
  }
  s->set_bodies(0, all, thrown);
  renew_ground(*s, 0, patch, start, 1.0);
  std::size_t back = 0;
  const auto now = s->bodies(0);
  for (const sim::BodyIndex i : virgin_grains(patch, start, 1.0)) {
    const Quat &a = now[std::size_t(i)].orientation, &b = start[std::size_t(i)].orientation;
    CHECK((a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z));
    ++back;
  }
  CHECK(back > start.size() / 4);
  CHECK(back < start.size());
}

TEST_CASE("clumps are stronger in shear than spheres of the same friction") {
  ShearSettings settings;
  settings.travel = 0.6;
  const sim::PairLaw law{0.5f, 0, 0};
  const auto ratio = [&](GrainShape shape) {
    BedSpec spec = shear_cell(0.1, 0.25, 1, shape);
    spec.length = 0.6;
    spec.width = 0.5;
    spec.depth = 0.5;
    const ShearResult r = shear_test(settle_packing(spec, 1), {law, law}, settings);
    return r.shear_stress / r.normal_stress;
  };
  const double sphere = ratio(GrainShape::sphere), trefoil = ratio(GrainShape::trefoil);
  std::printf("stress ratio of spheres %.3f, of trefoils %.3f\n", sphere, trefoil);
  CHECK(trefoil > sphere + 0.05);
}

TEST_CASE("a calibration keeps the shape of its grains, and tables without one are of spheres") {
  const TemporaryFolder folder;
  Calibration c;
  c.grain_diameter = 0.1;
  c.shape = GrainShape::trefoil;
  c.packing = {{0.8, 0.57, 0}, {0.02, 0.63, 1}};
  c.contact = {{0.1, 0, 15, 0.3, 0.1, 0.01}, {0.5, 0, 30, 0.4, 0.1, 0.01}};
  c.cohesion_gain = 0.1;
  write_calibration(folder / "table.json", c);
  CHECK(read_calibration(folder / "table.json").shape == GrainShape::trefoil);
  Json table = Json::read(folder / "table.json");
  table["shape"] = "cube";
  write_file_atomically(folder / "wrong.json", table.dump(1));
  refused([&] { read_calibration(folder / "wrong.json"); }, "shape");
  CHECK(read_calibration(GONOGO_SOURCE_DIR "/configs/soils/calibration_32mm.json").shape == GrainShape::sphere);
  CHECK(read_calibration(GONOGO_SOURCE_DIR "/configs/soils/calibration_90mm.json").shape == GrainShape::sphere);
}
