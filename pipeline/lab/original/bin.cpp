#include "pipeline/lab/original/bin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/units.h"

namespace gonogo::lab {
namespace {

enum Stream : std::uint64_t { first_stream = 1, choice_stream, angle_stream, distance_stream };

/// Square cells so small that each holds one point at most.
class PointGrid {
 public:
  PointGrid(double half_x, double half_y, double apart)
      : half_x_(half_x),
        half_y_(half_y),
        apart_(apart),
        cell_(apart / std::numbers::sqrt2),
        nx_(int(2 * half_x / cell_) + 1),
        ny_(int(2 * half_y / cell_) + 1),
        point_(std::size_t(nx_) * std::size_t(ny_), -1) {}

  bool takes(const std::vector<Vec3d>& points, const Vec3d& p) const {
    if (std::fabs(p.x) > half_x_ || std::fabs(p.y) > half_y_) return false;
    const int i = column(p), j = row(p);
    for (int b = std::max(0, j - 2); b <= std::min(ny_ - 1, j + 2); ++b)
      for (int a = std::max(0, i - 2); a <= std::min(nx_ - 1, i + 2); ++a)
        if (const int other = point_[index(a, b)]; other >= 0 && length(points[std::size_t(other)] - p) < apart_)
          return false;
    return true;
  }

  void put(int number, const Vec3d& p) { point_[index(column(p), row(p))] = number; }

 private:
  int column(const Vec3d& p) const { return std::min(nx_ - 1, int((p.x + half_x_) / cell_)); }
  int row(const Vec3d& p) const { return std::min(ny_ - 1, int((p.y + half_y_) / cell_)); }
  std::size_t index(int i, int j) const { return std::size_t(j) * std::size_t(nx_) + std::size_t(i); }

  double half_x_, half_y_, apart_, cell_;
  int nx_, ny_;
  std::vector<int> point_;
};

void add_wall(const Vec3d& centre, const Vec3& half, sim::SceneWorld& world) {
  sim::Shape s;
  s.type = sim::ShapeType::box;
  s.body = world.add_body({centre, {}, {}, {}}, sim::fixed_body());
  s.material = terrain::base_material;
  s.group = kPassesFloor;
  s.size = half;
  world.add_shape(s);
}

/// Floor with its spheres, centres on it.
void add_floor(const OriginalBin& bin, double radius, sim::SceneWorld& world) {
  sim::Shape s;
  s.body = world.add_body({}, sim::fixed_body());
  s.material = terrain::base_material;
  s.group = kPassesFloor;
  s.type = sim::ShapeType::plane;
  world.add_shape(s);
  s.type = sim::ShapeType::sphere;
  s.size = {Real(radius), 0, 0};
  const double pitch = bin.base_pitch * radius;
  const int nx = int(bin.half_length / pitch), ny = int(bin.half_width / pitch);
  for (int i = -nx; i <= nx; ++i)
    for (int j = -ny; j <= ny; ++j) {
      s.offset_B = {Real(i * pitch), Real(j * pitch), 0};
      world.add_shape(s);
    }
}

void add_walls(const OriginalBin& bin, sim::SceneWorld& world) {
  const double t = bin.half_wall, h = bin.half_height;
  for (const double side : {1.0, -1.0}) {
    add_wall({side * (bin.half_length + t), 0, h}, {Real(t), Real(bin.half_width + 2 * t), Real(h)}, world);
    add_wall({0, side * (bin.half_width + t), h}, {Real(bin.half_length), Real(t), Real(h)}, world);
  }
}

}  // namespace

int layer_count(const OriginalBin& bin, double radius) {
  return std::clamp(int(bin.depth / (2 * radius) + 1e-9), bin.min_layers, bin.max_layers);
}

std::vector<Vec3d> poisson_disk(double half_x, double half_y, double apart, std::uint64_t seed) {
  constexpr int trials = 30;
  PointGrid grid(half_x, half_y, apart);
  std::vector<Vec3d> points{{half_x * (2 * random_unit(seed, first_stream, 0) - 1),
                             half_y * (2 * random_unit(seed, first_stream, 1) - 1), 0}};
  grid.put(0, points[0]);
  std::vector<std::size_t> active{0};
  for (std::uint64_t round = 0; !active.empty(); ++round) {
    const auto chosen = std::size_t(random_unit(seed, choice_stream, round) * double(active.size()));
    const Vec3d around = points[active[chosen]];
    bool found = false;
    for (std::uint64_t t = 0; t < trials && !found; ++t) {
      const std::uint64_t draw = round * trials + t;
      const double angle = 2 * kPi * random_unit(seed, angle_stream, draw);
      // Uniform over the ring between one and two distances.
      const double r = apart * std::sqrt(1 + 3 * random_unit(seed, distance_stream, draw));
      const Vec3d p = around + Vec3d{r * std::cos(angle), r * std::sin(angle), 0};
      if (!grid.takes(points, p)) continue;
      grid.put(int(points.size()), p);
      active.push_back(points.size());
      points.push_back(p);
      found = true;
    }
    if (found) continue;
    active[chosen] = active.back();
    active.pop_back();
  }
  return points;
}

std::vector<Vec3d> dropped_grains(const OriginalBin& bin, double radius, std::uint64_t seed) {
  const double wide = bin.spread * radius;
  std::vector<Vec3d> grains;
  for (int layer = 0; layer < layer_count(bin, radius); ++layer)
    for (const Vec3d& p : poisson_disk(bin.half_length - wide, bin.half_width - wide, 2 * wide, seed + 7919u * layer))
      grains.push_back(p + Vec3d{0, 0, 2 * wide * (layer + 1)});
  return grains;
}

sim::SceneWorld bin_world(const OriginalBin& bin, const OriginalInput& input, double tyre_friction,
                          const std::vector<sim::BodyState>& grain) {
  // Of the domain [m]. A vehicle may slide back until its middle is at the rear wall, and fall out of the bin.
  constexpr double around = 0.5, behind = 3.5, above = 4, below = 6;
  sim::SceneWorld world;
  world.origin = {-bin.half_length - behind, -bin.half_width - around, -below};
  world.size = {2 * bin.half_length + behind + around, 2 * (bin.half_width + around), above + below};
  const sim::PairLaw soil{Real(input.friction), Real(0), Real(input.cohesion)};
  // The larger friction and the smaller cohesion of two materials act; tyres have none.
  const sim::PairLaw tyre{Real(std::max(input.friction, tyre_friction)), 0, 0};
  world.set_law(terrain::grain_material, terrain::grain_material, soil);
  world.set_law(terrain::grain_material, terrain::base_material, soil);
  world.set_law(terrain::grain_material, terrain::tool_material, tyre);
  world.set_law(terrain::base_material, terrain::tool_material, tyre);
  for (const sim::BodyState& g : grain) {
    const sim::BodyIndex b =
        world.add_sphere(g.position, Real(input.radius), Real(input.density), terrain::grain_material);
    world.body[std::size_t(b)] = g;
  }
  add_floor(bin, input.radius, world);
  add_walls(bin, world);
  return world;
}

}  // namespace gonogo::lab
