#include <memory>

#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/app/cli/command.h"
#include "sim/shape/meshes.h"
#include "sim/shape/sphere_cover.h"

namespace gonogo::app {
namespace {

struct SpheresRequest {
  std::filesystem::path mesh, out;
  double scale = 1;
  sim::CoverSettings cover;
};

Json vector_json(const Vec3d& v) { return Json(Json::Array{Json(v.x), Json(v.y), Json(v.z)}); }

Json cover_json(const sim::SphereCover& cover, const sim::SolidMoments& moments) {
  Json::Array list;
  for (const sim::CoverSphere& s : cover.sphere) {
    Json sphere = Json::object();
    sphere["centre_m"] = vector_json(s.centre);
    sphere["radius_m"] = s.radius;
    list.push_back(sphere);
  }
  Json json = Json::object();
  json["volume_m3"] = moments.volume;
  json["centre_of_mass_m"] = vector_json(moments.centre);
  json["volume_share"] = cover.volume_share;
  json["spheres"] = Json(list);
  return json;
}

void make_spheres(const Globals& globals, const SpheresRequest& request) {
  const sim::TriangleMesh mesh = sim::read_mesh(request.mesh, request.scale);
  const sim::SphereCover cover = sim::cover_by_spheres(mesh, request.cover);
  const Json json = cover_json(cover, sim::moments_of(mesh));
  if (!request.out.empty()) write_file_atomically(request.out, json.dump(2) + "\n");
  print_result(globals, json,
               line("%zu spheres hold %.3f of the volume of %s\n", cover.sphere.size(), cover.volume_share,
                    request.mesh.filename().c_str()));
}

}  // namespace

void add_mesh_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("mesh", "Tools for triangle meshes");
  command->require_subcommand(1);
  CLI::App* spheres = command->add_subcommand("spheres", "Fill a closed mesh with a few spheres");
  auto request = std::make_shared<SpheresRequest>();
  add_named(*spheres, "mesh", request->mesh, kFile, "STL or OBJ file")->required();
  spheres->add_option("--count", request->cover.count, "Max number of spheres")->check(CLI::Range(1, 100000));
  spheres->add_option("--share", request->cover.share, "Share of the volume at which to stop")
      ->check(CLI::Range(0.01, 1.0));
  spheres->add_option("--protrusion", request->cover.protrusion, "Max distance by which spheres stick out [m]")
      ->check(CLI::Range(0.0, 100.0));
  spheres->add_option("--cells", request->cover.cells, "Cells of the grid along the longest side")
      ->check(CLI::Range(2, 200));
  spheres->add_option("--scale", request->scale, "Metres per unit of the file")->check(CLI::Range(1e-6, 1e6));
  add_named(*spheres, "--out", request->out, kFile, "JSON file for the spheres");
  add_examples(*spheres, {"gonogo mesh spheres hull.stl --scale 0.001 --count 40 --out hull_spheres.json"});
  spheres->callback([&globals, request] { make_spheres(globals, *request); });
  add_examples(*command, {"gonogo mesh spheres hull.stl --count 40 --json"});
}

}  // namespace gonogo::app
