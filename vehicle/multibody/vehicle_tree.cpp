#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle::multibody {
namespace {

Matrix3 rotational_inertia(const Part& p) {
  Matrix3 m;
  m << p.moments.x, p.products.x, p.products.y, p.products.x, p.moments.y, p.products.z, p.products.y, p.products.z,
      p.moments.z;
  return m;
}

JointType joint_of(LinkType type) {
  if (type == LinkType::spherical) return JointType::spherical;
  return type == LinkType::prismatic ? JointType::prismatic : JointType::revolute;
}

/// The link that carries a body in the tree; none for the chassis.
const Link* carrier(const Assembly& a, int body) {
  for (const Link& link : a.link)
    if (!link.loop && link.child == body) return &link;
  return nullptr;
}

}  // namespace

VehicleTree vehicle_tree(const Assembly& assembly) {
  VehicleTree v;
  for (std::size_t i = 0; i < assembly.body.size(); ++i) {
    const Part& part = assembly.body[i];
    const Link* link = carrier(assembly, int(i));
    TreeBody body;
    body.type = JointType::floating;
    v.origin.push_back(Vector3::Zero());
    if (link) {
      v.origin.back() = vector(link->point);
      body.parent = link->parent;
      body.type = joint_of(link->type);
      if (body.type != JointType::spherical) body.axis = vector(link->axis);
      body.from_parent.r = v.local(link->parent, link->point);
    }
    body.inertia = spatial_inertia(part.mass, v.local(int(i), part.centre), rotational_inertia(part));
    v.tree.add(body);
  }
  for (const Link& link : assembly.link) {
    if (!link.loop) continue;
    const bool rod = link.type == LinkType::distance;
    const Vec3d& at_parent = rod ? link.parent_point : link.point;
    v.loop.push_back({.first = link.parent,
                      .second = link.child,
                      .first_point = v.local(link.parent, at_parent),
                      .second_point = v.local(link.child, link.point),
                      .length = rod ? length(link.point - link.parent_point) : 0});
  }
  for (const int wheel : assembly.wheel) v.axle.push_back(v.tree.body(wheel).first_velocity);
  return v;
}

}  // namespace gonogo::vehicle::multibody
