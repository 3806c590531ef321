#include <algorithm>

#include "base/error.h"
#include "base/file.h"
#include "base/hdf5/handle.h"

namespace gonogo {
using namespace hdf5;
namespace {

constexpr std::size_t kMemoryIncrement = std::size_t(1) << 20;  // [byte] by which the image in memory grows

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw InputError("HDF5 content: " + path + ": " + what);
}

void require(bool ok, const std::string& path, const char* what) {
  if (!ok) throw DeviceError("HDF5 content: " + path + ": cannot " + what + ": " + take_error());
}

void require_plain(const std::string& path, const std::string& value) {
  if (value.find('\0') != std::string::npos) refuse(path, "texts with zero bytes cannot be stored");
}

Handle space_of(const Shape& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  const std::vector<hsize_t> lengths(shape.begin(), shape.end());
  return {H5Screate_simple(int(lengths.size()), lengths.data(), nullptr), H5Sclose};
}

std::vector<const char*> pointers(const std::string& path, const std::vector<std::string>& values) {
  std::vector<const char*> result;
  for (const std::string& value : values) {
    require_plain(path, value);
    result.push_back(value.c_str());
  }
  return result;
}

Handle without_times(hid_t property_class) {
  Handle list(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

}  // namespace

struct Hdf5Writer::State {
  Handle file;

  State() {
    quiet();
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access.get(), kMemoryIncrement, false);
    H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18);
    const Handle creation = without_times(H5P_FILE_CREATE);
    file = Handle(H5Fcreate("memory", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
    require(file.valid(), "/", "start a file in memory");
  }

  Handle open_group(const std::vector<std::string>& parts, std::size_t depth) {
    Handle at(H5Gopen2(file.get(), "/", H5P_DEFAULT), H5Gclose);
    const Handle creation = without_times(H5P_GROUP_CREATE);
    std::string path;
    for (std::size_t i = 0; i < depth; ++i) {
      path += "/" + parts[i];
      const bool exists = H5Lexists(at.get(), parts[i].c_str(), H5P_DEFAULT) > 0;
      const hid_t next = exists ? H5Gopen2(at.get(), parts[i].c_str(), H5P_DEFAULT)
                                : H5Gcreate2(at.get(), parts[i].c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT);
      if (next < 0 && exists) refuse(path, "is an array, so nothing can be stored below it");
      require(next >= 0, path, "create this group");
      at = Handle(next, H5Gclose);
    }
    return at;
  }

  void store(const std::string& path, hid_t stored, hid_t memory, const void* data, const Shape& shape) {
    const std::vector<std::string> parts = split_path(path);
    if (parts.empty()) refuse(path, "an array needs a name");
    const Handle parent = open_group(parts, parts.size() - 1);
    if (H5Lexists(parent.get(), parts.back().c_str(), H5P_DEFAULT) > 0) refuse(path, "is stored already");
    const Handle space = space_of(shape);
    const Handle creation = without_times(H5P_DATASET_CREATE);
    const Handle set(
        H5Dcreate2(parent.get(), parts.back().c_str(), stored, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
        H5Dclose);
    require(set.valid(), path, "create this array");
    if (element_count(shape) == 0) return;
    require(H5Dwrite(set.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0, path, "store this array");
  }

  void annotate(const std::string& path, const std::string& name, hid_t stored, hid_t memory, const void* data,
                const Shape& shape) {
    const std::string where = path.empty() ? "/" : path;
    const Handle object(H5Oopen(file.get(), where.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.valid()) refuse(where, "no such group or array to attach '" + name + "' to");
    const Handle space = space_of(shape);
    const Handle attribute(H5Acreate2(object.get(), name.c_str(), stored, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    require(attribute.valid(), where + ":" + name, "create this attribute");
    if (element_count(shape) == 0) return;
    require(H5Awrite(attribute.get(), memory, data) >= 0, where + ":" + name, "store this attribute");
  }
};

Hdf5Writer::Hdf5Writer() : state_(std::make_unique<State>()) {}
Hdf5Writer::~Hdf5Writer() = default;
Hdf5Writer::Hdf5Writer(Hdf5Writer&&) noexcept = default;
Hdf5Writer& Hdf5Writer::operator=(Hdf5Writer&&) noexcept = default;

void Hdf5Writer::group(const std::string& path) {
  const std::vector<std::string> parts = split_path(path);
  state_->open_group(parts, parts.size());
}

template <class T>
void Hdf5Writer::array(const std::string& path, const T* values, std::size_t count, const Shape& shape) {
  if (element_count(shape) != count)
    refuse(path, std::to_string(count) + " values do not fill the shape " + to_text(shape));
  const ElementType type = element_type<T>();
  state_->store(path, type.stored, type.memory, values, shape);
}

template void Hdf5Writer::array(const std::string&, const float*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const double*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const std::int32_t*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const std::int64_t*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const std::uint8_t*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const std::uint32_t*, std::size_t, const Shape&);
template void Hdf5Writer::array(const std::string&, const std::uint64_t*, std::size_t, const Shape&);

void Hdf5Writer::text(const std::string& path, const std::string& value) {
  const Handle type = text_type();
  require_plain(path, value);
  const char* pointer = value.c_str();
  state_->store(path, type.get(), type.get(), &pointer, {});
}

void Hdf5Writer::texts(const std::string& path, const std::vector<std::string>& values) {
  const Handle type = text_type();
  state_->store(path, type.get(), type.get(), pointers(path, values).data(), {values.size()});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::string& value) {
  const Handle type = text_type();
  require_plain(path, value);
  const char* pointer = value.c_str();
  state_->annotate(path, name, type.get(), type.get(), &pointer, {});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const char* value) {
  attribute(path, name, std::string(value));
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, double value) {
  const ElementType type = element_type<double>();
  state_->annotate(path, name, type.stored, type.memory, &value, {});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, std::int64_t value) {
  const ElementType type = element_type<std::int64_t>();
  state_->annotate(path, name, type.stored, type.memory, &value, {});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::vector<double>& values) {
  const ElementType type = element_type<double>();
  state_->annotate(path, name, type.stored, type.memory, values.data(), {values.size()});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::vector<std::int64_t>& values) {
  const ElementType type = element_type<std::int64_t>();
  state_->annotate(path, name, type.stored, type.memory, values.data(), {values.size()});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::vector<std::string>& values) {
  const Handle type = text_type();
  state_->annotate(path, name, type.get(), type.get(), pointers(path, values).data(), {values.size()});
}

// H5Fget_file_image gives the size, but not the bytes: it clears a flag of the superblock after its checksum was taken.
std::string Hdf5Writer::image() const {
  require(H5Fflush(state_->file.get(), H5F_SCOPE_GLOBAL) >= 0, "/", "finish the file in memory");
  const ssize_t size = H5Fget_file_image(state_->file.get(), nullptr, 0);
  require(size > 0, "/", "size the file in memory");
  void* memory = nullptr;
  require(H5Fget_vfd_handle(state_->file.get(), H5P_DEFAULT, &memory) >= 0, "/", "copy the file in memory");
  std::string bytes(*static_cast<const char* const*>(memory), std::size_t(size));
  return bytes += seal_of(bytes);
}

void Hdf5Writer::save(const std::filesystem::path& path) const { write_file_atomically(path, image()); }

}  // namespace gonogo
