#include "sim/io/vtk_series.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/file.h"
#include "sim/io/surface.h"
#include "sim/io/vtp.h"
#include "sim/shape/touch.h"

namespace gonogo::sim {
namespace {

constexpr const char* kKinds[] = {"spheres", "surfaces", "contacts"};

std::string file_name(const std::string& kind, int frame) {
  char number[16];
  std::snprintf(number, sizeof number, "_%06d.vtp", frame);
  return kind + number;
}

VtpContent sphere_content(const Capture& frame, const std::vector<Shape>& shapes) {
  VtpContent content;
  std::vector<float> radius, speed;
  std::vector<std::int32_t> body, material;
  std::vector<Vec3> velocity, angular_velocity;
  for (const Shape& s : shapes) {
    if (s.type != ShapeType::sphere) continue;
    const BodyState& b = frame.body[s.body];
    content.point.push_back(centre_of(s, b));
    radius.push_back(s.size.x);
    velocity.push_back(velocity_of(s, b));
    angular_velocity.push_back(b.angular_velocity);
    speed.push_back(length(velocity.back()));
    body.push_back(s.body);
    material.push_back(s.material);
  }
  content.array = {{"radius", std::move(radius)},
                   {"velocity", std::move(velocity)},
                   {"angular_velocity", std::move(angular_velocity)},
                   {"speed", std::move(speed)},
                   {"body", std::move(body)},
                   {"material", std::move(material)}};
  return content;
}

VtpContent surface_content(const Capture& frame, const SceneWorld& drawn, Real plane_half) {
  VtpContent content;
  std::vector<std::int32_t> body, material;
  std::vector<Vec3> normal, velocity;
  for (const Shape& s : drawn.shape) {
    if (s.type == ShapeType::sphere) continue;
    const Surface surface = surface_of(drawn, s, {48, plane_half});
    const BodyState& b = frame.body[s.body];
    const Vec3d centre = centre_of(s, b);
    const Quat q = shape_orientation(s, b.orientation);
    const auto first = Index(content.point.size());
    for (const auto& t : surface.triangle) content.triangle.push_back({first + t[0], first + t[1], first + t[2]});
    for (std::size_t i = 0; i < surface.point.size(); ++i) {
      const Vec3 from_centre = rotate(q, surface.point[i]);
      content.point.push_back(centre + static_cast<Vec3d>(from_centre));
      normal.push_back(rotate(q, surface.normal[i]));
      velocity.push_back(velocity_of(s, b) + cross(b.angular_velocity, from_centre));
    }
    body.resize(content.point.size(), s.body);
    material.resize(content.point.size(), s.material);
  }
  content.array = {{"Normals", std::move(normal)},
                   {"velocity", std::move(velocity)},
                   {"body", std::move(body)},
                   {"material", std::move(material)}};
  return content;
}

VtpContent contact_content(const Capture& frame) {
  VtpContent content;
  std::vector<float> gap;
  std::vector<std::int32_t> body_a, body_b;
  std::vector<Vec3> normal, impulse;
  for (const CapturedContact& c : frame.contact) {
    content.point.push_back(c.point);
    normal.push_back(c.normal);
    impulse.push_back(c.impulse);
    gap.push_back(c.gap);
    body_a.push_back(c.a);
    body_b.push_back(c.b);
  }
  content.array = {{"normal", std::move(normal)},
                   {"impulse", std::move(impulse)},
                   {"gap", std::move(gap)},
                   {"body_a", std::move(body_a)},
                   {"body_b", std::move(body_b)}};
  return content;
}

}  // namespace

VtkSeries::VtkSeries(std::filesystem::path folder, const SceneWorld& world)
    : folder_(std::move(folder)), plane_half_(Real(std::max({world.size.x, world.size.y, world.size.z}) / 2)) {
  drawn_.shape = world.shape;
  drawn_.mesh = world.mesh;
  drawn_.heightfield = world.heightfield;
  create_folder(folder_);
  for (const char* kind : kKinds) write_collection(kind);
}

void VtkSeries::write(const Capture& frame) {
  const int k = frame_count();
  const std::array content{sphere_content(frame, drawn_.shape), surface_content(frame, drawn_, plane_half_),
                           contact_content(frame)};
  for (int i = 0; i < 3; ++i) {
    VtpContent timed = content[i];
    timed.time = frame.time;
    write_vtp(folder_ / file_name(kKinds[i], k), timed);
  }
  time_.push_back(frame.time);
  for (const char* kind : kKinds) write_collection(kind);
}

void VtkSeries::write_collection(const std::string& kind) const {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (int k = 0; k < frame_count(); ++k) {
    char time[32];
    std::snprintf(time, sizeof time, "%.9g", time_[k]);
    text += "    <DataSet timestep=\"" + std::string(time) + "\" group=\"\" part=\"0\" file=\"" + file_name(kind, k) +
            "\"/>\n";
  }
  write_file_atomically(folder_ / (kind + ".pvd"), text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace gonogo::sim
