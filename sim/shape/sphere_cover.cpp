#include "sim/shape/sphere_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <string>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::sim {
namespace {

using Corners = std::array<Vec3d, 3>;

std::vector<Corners> triangles_of(const TriangleMesh& mesh) {
  std::vector<Corners> all;
  for (const auto& [a, b, c] : mesh.triangle)
    all.push_back(
        {static_cast<Vec3d>(mesh.vertex[a]), static_cast<Vec3d>(mesh.vertex[b]), static_cast<Vec3d>(mesh.vertex[c])});
  return all;
}

/// Square of the distance from a segment.
double square_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  const Vec3d d = p - (a + along * t);
  return dot(d, d);
}

/// From a triangle: its plane where the foot lies inside of it, its edges elsewhere.
double square_to_triangle(const Vec3d& p, const Corners& t) {
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  bool inside = true;
  for (int k = 0; k < 3; ++k) inside = inside && dot(cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0;
  if (inside) {
    const double height = dot(p - t[0], normal);
    return height * height / dot(normal, normal);
  }
  return std::min(
      {square_to_segment(p, t[0], t[1]), square_to_segment(p, t[1], t[2]), square_to_segment(p, t[2], t[0])});
}

/// Solid angle of a triangle, positive seen from its back.
double solid_angle(const Vec3d& p, const Corners& t) {
  const Vec3d a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

double depth_inside(const std::vector<Corners>& triangles, const Vec3d& p) {
  double square = std::numeric_limits<double>::infinity(), angle = 0;
  for (const Corners& t : triangles) {
    square = std::min(square, square_to_triangle(p, t));
    angle += solid_angle(p, t);
  }
  return angle > 2 * kPi ? std::sqrt(square) : -std::sqrt(square);
}

struct Sample {
  Vec3d at;
  double depth;  // below the surface [m]
};

struct Grid {
  Vec3d low;    // [m]
  double cell;  // edge of a cell [m]
  int count[3];
};

/// Cubes over the box around the mesh.
Grid grid_over(const TriangleMesh& mesh, int cells) {
  Vec3d low = static_cast<Vec3d>(mesh.vertex.front()), high = low;
  for (const Vec3& v : mesh.vertex) {
    low = {std::min(low.x, double(v.x)), std::min(low.y, double(v.y)), std::min(low.z, double(v.z))};
    high = {std::max(high.x, double(v.x)), std::max(high.y, double(v.y)), std::max(high.z, double(v.z))};
  }
  const Vec3d size = high - low;
  Grid grid;
  grid.cell = std::max({size.x, size.y, size.z}) / cells;
  const auto count = [&](double length) { return std::max(1, int(std::ceil(length / grid.cell - 1e-6))); };
  grid.count[0] = count(size.x);
  grid.count[1] = count(size.y);
  grid.count[2] = count(size.z);
  const Vec3d whole{double(grid.count[0]), double(grid.count[1]), double(grid.count[2])};
  grid.low = (low + high) * 0.5 - whole * (grid.cell / 2);
  return grid;
}

/// Points of the grid that lie inside of the mesh, one a cell: `offset` 0.5 for the middles of the cells, 0 for their
/// corners.
std::vector<Sample> points_inside(const TriangleMesh& mesh, const Grid& grid, double offset) {
  const std::vector<Corners> triangles = triangles_of(mesh);
  std::vector<Sample> samples;
  for (int z = 0; z < grid.count[2]; ++z)
    for (int y = 0; y < grid.count[1]; ++y)
      for (int x = 0; x < grid.count[0]; ++x) {
        const Vec3d at = grid.low + Vec3d{x + offset, y + offset, z + offset} * grid.cell;
        if (const double depth = depth_inside(triangles, at); depth > 0) samples.push_back({at, depth});
      }
  return samples;
}

bool holds(const CoverSphere& sphere, const Vec3d& p) {
  const Vec3d d = p - sphere.centre;
  return dot(d, d) <= sphere.radius * sphere.radius;
}

/// Chooses spheres one by one. What a sphere adds can only fall as others are chosen, so that a candidate whose last
/// count is below the best new one need not be counted again (Minoux 1978).
class Greedy {
 public:
  Greedy(const std::vector<Sample>& samples, const std::vector<CoverSphere>& candidates)
      : samples_(samples), candidates_(candidates), held_(samples.size(), false) {
    for (std::size_t i = 0; i < candidates.size(); ++i) queue_.push({samples.size(), i});
  }

  std::size_t held() const { return held_count_; }

  /// The best sphere, or none when no sphere would add a sample.
  const CoverSphere* next() {
    while (!queue_.empty()) {
      const Candidate top = queue_.top();
      queue_.pop();
      const std::size_t gain = count(top.sphere);
      if (gain == 0) continue;
      if (!queue_.empty() && Candidate{gain, top.sphere} < queue_.top()) {
        queue_.push({gain, top.sphere});
        continue;
      }
      for_each_new(top.sphere, [&](std::size_t i) {
        held_[i] = true;
        ++held_count_;
      });
      return &candidates_[top.sphere];
    }
    return nullptr;
  }

 private:
  struct Candidate {
    std::size_t gain, sphere;  // gain: at most
    /// Of equal gains the first sphere wins.
    bool operator<(const Candidate& o) const { return gain != o.gain ? gain < o.gain : sphere > o.sphere; }
  };

  template <class Visit>
  void for_each_new(std::size_t sphere, const Visit& visit) const {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (!held_[i] && holds(candidates_[sphere], samples_[i].at)) visit(i);
  }

  std::size_t count(std::size_t sphere) const {
    std::size_t n = 0;
    for_each_new(sphere, [&](std::size_t) { ++n; });
    return n;
  }

  const std::vector<Sample>& samples_;
  const std::vector<CoverSphere>& candidates_;
  std::vector<bool> held_;
  std::size_t held_count_ = 0;
  std::priority_queue<Candidate> queue_;
};

/// Of the solid, by a grid twice as fine whose points are none of those the spheres were chosen by.
double share_held(const TriangleMesh& mesh, const SphereCover& cover, int cells) {
  const Grid grid = grid_over(mesh, 2 * cells + 1);
  const std::vector<Sample> samples = points_inside(mesh, grid, 0.5);
  const auto held = std::count_if(samples.begin(), samples.end(), [&](const Sample& sample) {
    return std::any_of(cover.sphere.begin(), cover.sphere.end(),
                       [&](const CoverSphere& sphere) { return holds(sphere, sample.at); });
  });
  return double(held) * grid.cell * grid.cell * grid.cell / moments_of(mesh).volume;
}

void check_cover(const TriangleMesh& mesh, const CoverSettings& s) {
  check_mesh(mesh);
  if (mesh.open) throw InputError("the mesh '" + mesh.name + "' is open; only solids can be made of spheres");
  if (s.count < 1) throw InputError("a solid must be made of at least one sphere, not " + std::to_string(s.count));
  if (s.cells < 2 || s.cells > 200)
    throw InputError("the grid has " + std::to_string(s.cells) + " cells along the longest side; 2 to 200 are allowed");
  if (!(s.share > 0) || s.share > 1)
    throw InputError("the share of the volume is " + std::to_string(s.share) + "; it must be above 0 and at most 1");
  if (!(s.protrusion >= 0) || !std::isfinite(s.protrusion))
    throw InputError("the protrusion is " + std::to_string(s.protrusion) + " m; it must be at least 0");
}

}  // namespace

double depth_inside(const TriangleMesh& mesh, const Vec3d& point) { return depth_inside(triangles_of(mesh), point); }

SphereCover cover_by_spheres(const TriangleMesh& mesh, const CoverSettings& settings) {
  check_cover(mesh, settings);
  const Grid grid = grid_over(mesh, settings.cells);
  const std::vector<Sample> samples = points_inside(mesh, grid, 0.5);
  if (samples.empty())
    throw InputError("the mesh '" + mesh.name + "' is thinner than the grid of " + std::to_string(settings.cells) +
                     " cells along its longest side; take more cells");
  std::vector<CoverSphere> candidates;
  for (const double offset : {0.0, 0.5})
    for (const Sample& p : points_inside(mesh, grid, offset))
      candidates.push_back({p.at, p.depth + settings.protrusion});
  SphereCover cover;
  Greedy greedy(samples, candidates);
  const auto wanted = std::size_t(std::ceil(settings.share * double(samples.size())));
  while (int(cover.sphere.size()) < settings.count && greedy.held() < wanted) {
    const CoverSphere* best = greedy.next();
    if (best == nullptr) break;
    cover.sphere.push_back(*best);
  }
  cover.volume_share = share_held(mesh, cover, settings.cells);
  return cover;
}

/// Sums over tetrahedra from the origin: volume V = det / 6, first moments V (a + b + c) / 4, second moments
/// V (sum over corners of x_i x_j + (sum x_i)(sum x_j)) / 20.
SolidMoments moments_of(const TriangleMesh& mesh) {
  SolidMoments m;
  double second[3][3]{};
  for (const Corners& t : triangles_of(mesh)) {
    const double volume = dot(t[0], cross(t[1], t[2])) / 6;
    const Vec3d sum = t[0] + t[1] + t[2];
    m.volume += volume;
    m.centre += sum * (volume / 4);
    const double s[3] = {sum.x, sum.y, sum.z};
    const double x[3][3] = {{t[0].x, t[0].y, t[0].z}, {t[1].x, t[1].y, t[1].z}, {t[2].x, t[2].y, t[2].z}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        second[i][j] += volume / 20 * (s[i] * s[j] + x[0][i] * x[0][j] + x[1][i] * x[1][j] + x[2][i] * x[2][j]);
  }
  m.centre = m.centre * (1 / m.volume);
  const double c[3] = {m.centre.x, m.centre.y, m.centre.z};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) second[i][j] -= m.volume * c[i] * c[j];
  const double trace = second[0][0] + second[1][1] + second[2][2];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m.inertia[i][j] = (i == j ? trace : 0) - second[i][j];
  return m;
}

}  // namespace gonogo::sim
