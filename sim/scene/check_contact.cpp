#include "sim/scene/check_contact.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.h"
#include "sim/contact/find.h"
#include "sim/scene/check_shape.h"

namespace gonogo::sim {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

/// The name of a shape with its body as the scene counts it.
std::string described(const FlatWorld& flat, ShapeIndex i) {
  const Shape& s = flat.shape[i];
  const auto at = std::find(flat.place_of_body.begin(), flat.place_of_body.end(), s.body);
  return std::string(name_of(s.type)) + " of body " + std::to_string(at - flat.place_of_body.begin());
}

std::string in_world(WorldIndex w) { return "world " + std::to_string(w) + ": "; }

/// A world by itself, ready for the broad phase.
State<Cpu> state_of(const FlatWorld& flat) {
  State<Cpu> s;
  SurfaceLibrary library;
  std::vector<Shape> shape = flat.shape;
  for (Shape& each : shape) {
    if (each.type == ShapeType::mesh) each.surface = library.add(flat.mesh[each.surface]);
    if (each.type == ShapeType::heightfield) each.surface = library.add(flat.heightfield[each.surface]);
  }
  std::vector<Vec3d> position;
  std::vector<Quat> orientation;
  for (const BodyState& b : flat.body) {
    position.push_back(b.position);
    orientation.push_back(b.orientation);
  }
  s.surfaces.upload(library);
  s.position.upload(position);
  s.orientation.upload(orientation);
  s.mass.upload(flat.mass);
  s.world.upload({flat.world});
  s.world_of_body.upload(std::vector<WorldIndex>(flat.body.size()));
  s.shape.upload(shape);
  s.bin_of_shape.upload(flat.bin_of_shape);
  s.large.upload(flat.large);
  reserve_large_groups(s, Index(flat.large.size()), Index(flat.large.size()));
  s.mechanisms.body.upload(flat.mechanisms.body);
  s.shape_count = Index(shape.size());
  s.solids_binned = true;
  s.bin_count = flat.size().bins;
  s.centre.fill_zero(s.shape_count);
  s.shape_in_bin.fill_zero(s.shape_count);
  s.shape_by_bin.fill_zero(s.shape_count);
  s.bin_cursor.fill_zero(s.bin_count);
  s.first_in_bin.fill_zero(s.bin_count + 1);
  return s;
}

void refuse_overlap(const FlatWorld& flat, WorldIndex w, ShapeIndex i, ShapeIndex j, Real overlap, Real allowed) {
  throw InputError(in_world(w) + "the " + described(flat, i) + " and the " + described(flat, j) + " overlap by " +
                   number(overlap) + " m, at most " + number(allowed) +
                   " m are allowed at the start; move them apart or raise the world's overlap_limit");
}

}  // namespace

void check_pairs(const FlatWorld& flat, WorldIndex w) {
  State<Cpu> s;
  s.shape.upload(flat.shape);
  s.mass.upload(flat.mass);
  s.mechanisms.body.upload(flat.mechanisms.body);
  ContactFinder find{};
  find.shape = s.shape.view();
  find.mass = s.mass.view();
  find.jointed = s.mechanisms.body.view();
  std::vector<ShapeIndex> of_type[kShapeTypes];
  for (std::size_t i = 0; i < flat.shape.size(); ++i) of_type[int(flat.shape[i].type)].push_back(ShapeIndex(i));
  for (int a = 0; a < kShapeTypes; ++a)
    for (int b = a; b < kShapeTypes; ++b) {
      if (have_routine(ShapeType(a), ShapeType(b))) continue;
      for (const ShapeIndex i : of_type[a])
        for (const ShapeIndex j : of_type[b])
          if (find.may_touch(i, j))
            throw InputError(in_world(w) + "the " + described(flat, i) + " may meet the " + described(flat, j) +
                             ", and contacts between these two are not implemented; give them one group when they "
                             "should not touch, or use other shapes");
    }
}

void check_overlaps(const FlatWorld& flat, WorldIndex w, const StepSettings& settings, Real limit) {
  State<Cpu> s = state_of(flat);
  const Cpu exec{1};
  sort_into_bins(exec, s);
  const ContactFinder finder = contact_finder(s, settings);
  for (ShapeIndex i = 0; i < s.shape_count; ++i)
    finder.visit_contacts(i, [&](ShapeIndex j, int, const Touch& t, const Vec3d&) {
      const Real a = smallest_half(flat.shape[i]), b = smallest_half(flat.shape[j]);
      const Real allowed = limit * (a > 0 && b > 0 ? std::min(a, b) : std::max(a, b));
      if (t.gap < -allowed) refuse_overlap(flat, w, i, j, -t.gap, allowed);
    });
}

}  // namespace gonogo::sim
