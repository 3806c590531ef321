#include "pipeline/campaign/trial/saved_run.h"

#include "sim/io/checkpoint.h"

namespace gonogo::campaign {
namespace {

constexpr const char* kGroup = "trial";
constexpr const char* kBed = "trial/bed";
constexpr const char* kGrains = "trial/bed/grains";
constexpr std::size_t kColumns = 7;

}  // namespace

void save_run(const std::filesystem::path& path, const RunState& state) {
  Hdf5Writer out;
  out.group(kGroup);
  out.attribute(kGroup, "attempt", std::int64_t(state.attempt));
  if (state.bed) {
    out.group(kBed);
    out.attribute(kBed, "scene", state.bed_scene);
    out.attribute(kBed, "creep", state.bed->creep);
    out.attribute(kBed, "residual", state.bed->residual);
    std::vector<double> rows;
    for (const auto& [x, q] : state.bed->grain) rows.insert(rows.end(), {x.x, x.y, x.z, q.w, q.x, q.y, q.z});
    out.array(kGrains, rows, {state.bed->grain.size(), kColumns});
    out.attribute(kGrains, "columns",
                  std::vector<std::string>{"x [m]", "y [m]", "z [m]", "orientation w", "x", "y", "z"});
  }
  sim::store_snapshot(out, state.world, state.scene);
  out.save(path);
}

SavedRun::SavedRun(const std::filesystem::path& path) : in_(path) {
  if (!in_.has(kGroup)) in_.fail(kGroup, "this is no checkpoint of a trial; name another file or remove this one");
}

std::uint64_t SavedRun::attempt() const {
  const std::int64_t attempt = in_.integer_attribute(kGroup, "attempt");
  if (attempt != 1 && attempt != 2)
    in_.fail(kGroup, "attempt is " + std::to_string(attempt) + ", allowed are 1 and 2; remove the file");
  return std::uint64_t(attempt);
}

bool SavedRun::driving() const { return in_.has(kBed); }

TiltedBed SavedRun::bed(const std::string& bed_scene) const {
  if (in_.text_attribute(kBed, "scene") != bed_scene)
    in_.fail(kBed,
             "belongs to another scene or other numerics; give the file the trial it came from, or remove it and "
             "start from the beginning");
  TiltedBed bed;
  bed.creep = in_.number_attribute(kBed, "creep");
  bed.residual = in_.number_attribute(kBed, "residual");
  const auto shape = in_.shape(kGrains);
  if (shape.size() != 2 || shape[1] != kColumns)
    in_.fail(kGrains, "expected seven columns; remove the file, and the trial starts from the beginning");
  const auto rows = in_.array<double>(kGrains);
  for (std::size_t i = 0; i + kColumns <= rows.size(); i += kColumns)
    bed.grain.push_back({{rows[i], rows[i + 1], rows[i + 2]},
                         {Real(rows[i + 3]), Real(rows[i + 4]), Real(rows[i + 5]), Real(rows[i + 6])}});
  return bed;
}

sim::Snapshot SavedRun::world(const std::string& scene) const { return sim::read_snapshot(in_, scene); }

}  // namespace gonogo::campaign
