#include "sim/io/part_files.h"

#include <algorithm>
#include <mutex>

#include "base/error.h"
#include "base/files/file.h"
#include "sim/io/checkpoint.h"

namespace gonogo::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGroup = "parts";
constexpr const char* kFiles = "parts/file";
constexpr const char* kEnding = ".part";
constexpr std::size_t kHashDigits = 32;  // of content_hash()

/// "trial.h5.<hash>.part2".
std::string part_name(const fs::path& checkpoint, const std::string& content, int part) {
  return checkpoint.filename().string() + "." + content + kEnding + std::to_string(part);
}

/// Whether part_name() gives such names for this checkpoint.
bool is_part_of(const fs::path& checkpoint, const std::string& name) {
  constexpr const char *hexadecimal = "0123456789abcdef", *decimal = "0123456789";
  const std::string start = checkpoint.filename().string() + ".";
  const std::size_t ending = name.rfind(kEnding), number = ending + std::string(kEnding).size();
  return name.starts_with(start) && ending != std::string::npos && ending == start.size() + kHashDigits &&
         name.find_first_not_of(hexadecimal, start.size()) == ending && number < name.size() &&
         name.find_first_not_of(decimal, number) == std::string::npos;
}

fs::path beside(const fs::path& checkpoint, const std::string& name) { return checkpoint.parent_path() / name; }

std::string write_part(const fs::path& checkpoint, const Snapshot& own, int part, const std::string& scene) {
  static std::mutex hdf5;
  const std::lock_guard lock(hdf5);
  Hdf5Writer out;
  const std::string name = part_name(checkpoint, store_snapshot(out, own, scene), part);
  out.save(beside(checkpoint, name));
  return name;
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// Adds the bodies and contacts of the next part.
void append(Snapshot& to, const Snapshot& part) {
  const auto before = Index(to.key.size());
  append(to.position, part.position);
  append(to.orientation, part.orientation);
  append(to.velocity, part.velocity);
  for (const Index i : part.contact_begin) to.contact_begin.push_back(before + i);
  for (const Index i : part.contact_end) to.contact_end.push_back(before + i);
  append(to.key, part.key);
  append(to.impulse, part.impulse);
}

}  // namespace

std::vector<std::string> write_parts(const fs::path& checkpoint, InParts& world, const std::string& scene) {
  return world.each_part([&](const Snapshot& own, int part) { return write_part(checkpoint, own, part, scene); });
}

void store_parts(Hdf5Writer& out, const std::vector<std::string>& names) {
  out.group(kGroup);
  out.texts(kFiles, names);
}

bool has_parts(const Hdf5Reader& checkpoint) { return checkpoint.has(kGroup); }

Snapshot read_parts(const Hdf5Reader& checkpoint, const std::string& scene) {
  Snapshot whole;
  int number = 0;
  for (const std::string& name : checkpoint.texts(kFiles)) {
    const fs::path file = beside(checkpoint.path(), name);
    const Hdf5Reader in(file);
    std::string content;
    const Snapshot part = read_snapshot(in, scene, &content);
    if (name != part_name(checkpoint.path(), content, number))
      in.fail(kGroup, "is another part than " + checkpoint.path().string() +
                          " names; remove both and start from the beginning");
    if (number++ == 0)
      whole = part;
    else
      append(whole, part);
  }
  if (number == 0) checkpoint.fail(kFiles, "names no parts; remove the file and start from the beginning");
  return whole;
}

void remove_parts_but(const std::vector<std::string>& names, const fs::path& checkpoint) {
  std::error_code ignored;
  const fs::path folder = checkpoint.parent_path().empty() ? fs::path(".") : checkpoint.parent_path();
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_part_of(checkpoint, name) && std::find(names.begin(), names.end(), name) == names.end())
      old.push_back(entry.path());
  }
  for (const fs::path& file : old) fs::remove(file, ignored);
}

void save_checkpoint_by_parts(const fs::path& path, InParts& world, const std::string& scene, bool first) {
  const std::vector<std::string> names = write_parts(path, world, scene);
  if (!first) return;
  Hdf5Writer out;
  store_parts(out, names);
  out.save(path);
  remove_parts_but(names, path);
}

}  // namespace gonogo::sim
