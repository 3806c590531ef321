#include "sim/shape/surface_library.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace gonogo::sim {
namespace {

constexpr Index kLeaf = 4;  // max triangles of a leaf

struct Box {
  Vec3 low, high;
};

Box box_of(const TriangleMesh& mesh, const std::array<Index, 3>& corner) {
  const Vec3 &a = mesh.vertex[corner[0]], &b = mesh.vertex[corner[1]], &c = mesh.vertex[corner[2]];
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

void extend(Box& box, const Box& by) {
  box.low = {std::min(box.low.x, by.low.x), std::min(box.low.y, by.low.y), std::min(box.low.z, by.low.z)};
  box.high = {std::max(box.high.x, by.high.x), std::max(box.high.y, by.high.y), std::max(box.high.z, by.high.z)};
}

/// Builds the tree depth first; a node is halved at the median of its middles along its longest side.
struct TreeBuilder {
  const std::vector<Box>& box;  // [triangle of the source]
  std::vector<Index>& order;    // triangles of the source in the order of the leaves
  std::vector<MeshNode>& node;  // grows
  std::size_t first_node;       // of this mesh

  Real middle(Index t, int axis) const {
    const Vec3 sum = box[t].low + box[t].high;
    return axis == 0 ? sum.x : axis == 1 ? sum.y : sum.z;
  }

  void build(Index begin, Index end) {
    Box around = box[order[begin]];
    for (Index k = begin; k < end; ++k) extend(around, box[order[k]]);
    const std::size_t me = node.size();
    node.push_back({around.low, begin, around.high, end - begin <= kLeaf ? end - begin : 0, 0});
    if (end - begin > kLeaf) {
      const Vec3 side = around.high - around.low;
      const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
      const Index half = begin + (end - begin) / 2;
      std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end, [&](Index a, Index b) {
        const Real at_a = middle(a, axis), at_b = middle(b, axis);
        return at_a != at_b ? at_a < at_b : a < b;
      });
      build(begin, half);
      build(half, end);
    }
    node[me].skip = Index(node.size() - first_node);
  }
};

void find_neighbours(std::vector<MeshTriangle>& triangle) {
  std::map<std::pair<Index, Index>, Index> owner;  // directed edge -> its triangle
  for (std::size_t t = 0; t < triangle.size(); ++t)
    for (int k = 0; k < 3; ++k) owner[{triangle[t].vertex[k], triangle[t].vertex[(k + 1) % 3]}] = Index(t);
  std::vector<bool> seen;
  for (std::size_t t = 0; t < triangle.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index v = triangle[t].vertex[k];
      const auto other = owner.find({triangle[t].vertex[(k + 1) % 3], v});
      triangle[t].neighbour[k] = other == owner.end() ? -1 : other->second;
      if (std::size_t(v) >= seen.size()) seen.resize(std::size_t(v) + 1);
      if (!seen[v]) triangle[t].marks |= MeshMark::first << k;
      seen[v] = true;
    }
}

/// Sine of the angle between the faces beside an edge: above zero along a valley, below along a ridge or rim.
Real bend(const SurfaceFrom<MeshSurface>& mesh, Index t, int k) {
  if (mesh.surface.neighbour(t, k) < 0) return -1;
  const Vec3 beyond = mesh.across(t, k);
  return dot(beyond, mesh.normal(t)) / length(beyond);
}

constexpr Real kFlat = Real(1e-3);  // sine or angle [rad]

/// Whether the edges of a corner that are not flat are more than two in a line.
bool is_sharp(const SurfaceFrom<MeshSurface>& mesh, Index t, int k) {
  std::vector<Vec3> bent;
  const auto add = [&](Index r, int edge, const Vec3& way) {
    if (std::fabs(bend(mesh, r, edge)) > kFlat) bent.push_back(way * (1 / length(way)));
  };
  mesh.visit_ring(t, k, [&](Index r, int c) {
    const int last = (c + 2) % 3;
    add(r, c, mesh.corner(r, (c + 1) % 3) - mesh.corner(r, c));
    if (mesh.surface.neighbour(r, last) < 0) add(r, last, mesh.corner(r, last) - mesh.corner(r, c));
  });
  if (bent.size() == 2) return length(bent[0] + bent[1]) > kFlat;
  return !bent.empty();
}

void mark_corners_and_edges(const MeshRange& range, const std::vector<Vec3>& vertex,
                            std::vector<MeshTriangle>& triangle) {
  const MeshSurface surface{range, nullptr, triangle.data(), vertex.data()};
  const SurfaceFrom<MeshSurface> mesh{surface, {}};
  for (Index t = 0; t < Index(triangle.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index other = triangle[t].neighbour[k];
      const Real sine = bend(mesh, t, k);
      if (sine < -kFlat && (other < 0 || t < other)) triangle[t].marks |= MeshMark::ridge << k;
      if (sine > kFlat) triangle[t].marks |= MeshMark::valley << k;
      if (surface.has(MeshMark::first, t, k) && is_sharp(mesh, t, k)) triangle[t].marks |= MeshMark::sharp << k;
    }
}

/// Names each triangle by the first one of its flat face: neighbours whose normals agree to 1e-3 rad.
template <class Neighbour, class Normal>
std::vector<Index> face_names(Index count, Neighbour&& neighbour, Normal&& normal) {
  std::vector<Index> name(count, -1), open;
  for (Index start = 0; start < count; ++start) {
    if (name[start] >= 0) continue;
    name[start] = start;
    const Vec3d face = normal(start);
    open = {start};
    while (!open.empty()) {
      const Index t = open.back();
      open.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Index other = neighbour(t, k);
        if (other < 0 || name[other] >= 0 || !(length(cross(face, normal(other))) < 1e-3) ||
            dot(face, normal(other)) < 0)
          continue;
        name[other] = start;
        open.push_back(other);
      }
    }
  }
  return name;
}

Vec3d unit_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a);
  GONOGO_ASSERT(length(n) > 0);  // check_mesh has refused it
  return n * (1 / length(n));
}

/// Unit outward normals.
std::vector<Vec3d> normals_of(const std::vector<MeshTriangle>& triangle, const std::vector<Vec3>& vertex) {
  std::vector<Vec3d> normal;
  for (const MeshTriangle& t : triangle) {
    const auto corner = [&](int k) { return static_cast<Vec3d>(vertex[t.vertex[k]]); };
    const Vec3d n = cross(corner(1) - corner(0), corner(2) - corner(0));
    normal.push_back(n * (1 / length(n)));
  }
  return normal;
}

bool has_rim(const MeshTriangle& t) { return t.neighbour[0] < 0 || t.neighbour[1] < 0 || t.neighbour[2] < 0; }

bool has_valley(const MeshTriangle& t) { return (t.marks & (MeshMark::valley * 7)) != 0; }

/// About the mean of the normals of triangles `begin` to `end` and their neighbours.
NormalCone cone_around(const std::vector<MeshTriangle>& triangle, const std::vector<Vec3d>& normal, Index begin,
                       Index end) {
  Vec3d sum;
  bool hollow = false;
  for (Index t = begin; t < end; ++t) {
    if (has_rim(triangle[t])) return {};
    hollow = hollow || has_valley(triangle[t]);
    sum += normal[t];
  }
  if (length(sum) < 1e-3 * (end - begin)) return {};
  const Vec3d axis = sum * (1 / length(sum));
  double least = 1;
  for (Index t = begin; t < end; ++t) {
    least = std::min(least, dot(axis, normal[t]));
    for (const Index other : triangle[t].neighbour) least = std::min(least, dot(axis, normal[other]));
  }
  if (least < 1e-3) return {};
  return {static_cast<Vec3>(axis), Real(hollow ? 1e-6 - least : least - 1e-6)};
}

/// [node] Cones of normals for the nodes of one mesh, depth first, and its triangles in the order of their leaves,
/// marked and with neighbours.
std::vector<NormalCone> normal_cones(const MeshNode* node, Index nodes, const std::vector<MeshTriangle>& triangle,
                                     const std::vector<Vec3>& vertex) {
  const std::vector<Vec3d> normal = normals_of(triangle, vertex);
  std::vector<NormalCone> cone;
  for (Index n = 0; n < nodes; ++n) {
    const Index end = node[n].skip < nodes ? node[node[n].skip].first : Index(triangle.size());
    GONOGO_ASSERT(node[n].first < end && end <= Index(triangle.size()));
    cone.push_back(cone_around(triangle, normal, node[n].first, end));
  }
  return cone;
}

}  // namespace

Index SurfaceLibrary::add(const std::shared_ptr<const TriangleMesh>& source) {
  const auto known = std::find(mesh_source_.begin(), mesh_source_.end(), source);
  if (known != mesh_source_.end()) return Index(known - mesh_source_.begin());
  MeshRange range{.node = Index(node.size()),
                  .node_count = 0,
                  .triangle = Index(triangle.size()),
                  .vertex = Index(vertex.size()),
                  .open = source->open ? 1 : 0,
                  .low = {},
                  .high = {}};
  std::vector<Box> box;
  for (const auto& corner : source->triangle) box.push_back(box_of(*source, corner));
  std::vector<Index> order(box.size());
  std::iota(order.begin(), order.end(), 0);
  TreeBuilder{box, order, node, node.size()}.build(0, Index(order.size()));
  range.node_count = Index(node.size()) - range.node;
  range.low = node[range.node].low;
  range.high = node[range.node].high;
  std::vector<MeshTriangle> own;
  for (const Index t : order) {
    const auto& c = source->triangle[t];
    own.push_back({{c[0], c[1], c[2]}, {-1, -1, -1}, 0, 0});
  }
  find_neighbours(own);
  const auto place = [&](Index t, int k) { return static_cast<Vec3d>(source->vertex[own[t].vertex[k]]); };
  const std::vector<Index> names = face_names(
      Index(own.size()), [&](Index t, int k) { return own[t].neighbour[k]; },
      [&](Index t) { return unit_normal(place(t, 0), place(t, 1), place(t, 2)); });
  for (std::size_t t = 0; t < own.size(); ++t) own[t].name = names[t];
  mark_corners_and_edges(range, source->vertex, own);
  const std::vector<NormalCone> own_cones =
      normal_cones(node.data() + range.node, range.node_count, own, source->vertex);
  cone.insert(cone.end(), own_cones.begin(), own_cones.end());
  triangle.insert(triangle.end(), own.begin(), own.end());
  vertex.insert(vertex.end(), source->vertex.begin(), source->vertex.end());
  mesh.push_back(range);
  mesh_source_.push_back(source);
  return Index(mesh.size()) - 1;
}

Index SurfaceLibrary::add(const std::shared_ptr<const Heightfield>& source) {
  const auto known = std::find(field_source_.begin(), field_source_.end(), source);
  if (known != field_source_.end()) return Index(known - field_source_.begin());
  const auto [low, high] = std::minmax_element(source->height.begin(), source->height.end());
  const FieldRange range{.height = Index(height.size()),
                         .name = Index(name.size()),
                         .nx = source->nx,
                         .ny = source->ny,
                         .spacing_x = source->spacing_x,
                         .spacing_y = source->spacing_y,
                         .low = *low,
                         .high = *high};
  const FieldSurface surface{range, source->height.data(), nullptr};
  const std::vector<Index> names = face_names(
      2 * (source->nx - 1) * (source->ny - 1), [&](Index t, int k) { return surface.neighbour(t, k); },
      [&](Index t) {
        return unit_normal(surface.place(surface.vertex(t, 0)), surface.place(surface.vertex(t, 1)),
                           surface.place(surface.vertex(t, 2)));
      });
  height.insert(height.end(), source->height.begin(), source->height.end());
  name.insert(name.end(), names.begin(), names.end());
  field.push_back(range);
  field_source_.push_back(source);
  return Index(field.size()) - 1;
}

SurfaceView SurfaceLibrary::view() const {
  return {.mesh = {mesh.data(), Index(mesh.size())},
          .node = {node.data(), Index(node.size())},
          .cone = {cone.data(), Index(cone.size())},
          .triangle = {triangle.data(), Index(triangle.size())},
          .vertex = {vertex.data(), Index(vertex.size())},
          .field = {field.data(), Index(field.size())},
          .height = {height.data(), Index(height.size())},
          .name = {name.data(), Index(name.size())}};
}

}  // namespace gonogo::sim
