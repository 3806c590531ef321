#include "base/hdf5/hdf5.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <cstdint>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/foreign.h"
#include "base/hdf5/handle.h"
#include "base/hdf5/open_file.h"

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

namespace fs = std::filesystem;
namespace {

void require_readable(const fs::path& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
  if (fs::is_directory(path, ec)) throw InputError(path.string() + ": is a folder, an HDF5 file is needed");
  if (::access(path.c_str(), R_OK) != 0) throw InputError(path.string() + ": cannot be read; check its permissions");
}

/// A file's bytes, mapped for one pass over them.
class MappedFile {
 public:
  explicit MappedFile(const fs::path& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    const off_t size = ::lseek(fd, 0, SEEK_END);
    void* const start = size > 0 ? ::mmap(nullptr, std::size_t(size), PROT_READ, MAP_PRIVATE, fd, 0) : MAP_FAILED;
    if (start != MAP_FAILED) bytes_ = {static_cast<const char*>(start), std::size_t(size)};
    ::close(fd);
  }
  ~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<char*>(bytes_.data()), bytes_.size());
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
};

/// Where HDF5's own bytes end, by a superblock of version 2 or 3, as written here; 0 in other files.
std::uint64_t end_of_content(std::string_view file) {
  constexpr std::size_t kVersion = 8, kEnd = 28, kWidth = 8;
  if (file.size() < kEnd + kWidth || (file[kVersion] != 2 && file[kVersion] != 3)) return 0;
  std::uint64_t end = 0;
  for (std::size_t k = kWidth; k-- > 0;) end = end << 8 | static_cast<unsigned char>(file[kEnd + k]);
  return end;
}

/// Whether the file ends with a seal, which holds. Without one it is a file of another program.
bool is_sealed_and_intact(const fs::path& path) {
  const MappedFile file(path);
  const std::string_view content = without_seal(file.bytes());
  const bool is_sealed = content.size() != file.bytes().size();
  const std::uint64_t end = end_of_content(content);
  // What lies behind HDF5's own end is a seal, or was one.
  if (is_sealed ? seal_of(content) != file.bytes().substr(content.size()) : end != 0 && content.size() > end)
    throw InputError(path.string() + ": is damaged (its bytes do not match the hash at its end); make it again");
  return is_sealed;
}

OpenFile opened(const fs::path& path) {
  require_readable(path);
  return is_sealed_and_intact(path) ? OpenFile::of_disk(path) : open_foreign(path);
}

}  // namespace

struct Hdf5Reader::State : OpenFile {};

Hdf5Reader::Hdf5Reader(const fs::path& path) : state_(std::make_unique<State>(State{opened(path)})) {}
Hdf5Reader::~Hdf5Reader() = default;
Hdf5Reader::Hdf5Reader(Hdf5Reader&&) noexcept = default;
Hdf5Reader& Hdf5Reader::operator=(Hdf5Reader&&) noexcept = default;

const fs::path& Hdf5Reader::path() const { return state_->path; }
bool Hdf5Reader::has(const std::string& path) const { return state_->has(path); }
void Hdf5Reader::fail(const std::string& path, const std::string& message) const { state_->fail(path, message); }
Shape Hdf5Reader::shape(const std::string& path) const { return shape_of(state_->open_array(path).space.get()); }

std::vector<std::string> Hdf5Reader::members(const std::string& group) const { return state_->members(group); }

template <class T>
std::vector<T> Hdf5Reader::array(const std::string& path, const std::optional<Shape>& expected) const {
  return state_->fetch<T>(state_->open_array(path), expected);
}

template std::vector<float> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<double> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<std::int32_t> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<std::int64_t> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<std::uint8_t> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<std::uint32_t> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;
template std::vector<std::uint64_t> Hdf5Reader::array(const std::string&, const std::optional<Shape>&) const;

std::string Hdf5Reader::text(const std::string& path) const {
  return state_->fetch_texts(state_->open_array(path), true).front();
}

std::vector<std::string> Hdf5Reader::texts(const std::string& path) const {
  return state_->fetch_texts(state_->open_array(path), false);
}

bool Hdf5Reader::has_attribute(const std::string& path, const std::string& name) const {
  return has(path) &&
         H5Aexists_by_name(state_->file.get(), path.empty() ? "/" : path.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

std::string Hdf5Reader::text_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch_texts(state_->open_attribute(path, name), true).front();
}

double Hdf5Reader::number_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch<double>(state_->open_attribute(path, name), Shape{}).front();
}

std::int64_t Hdf5Reader::integer_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch<std::int64_t>(state_->open_attribute(path, name), Shape{}).front();
}

std::vector<double> Hdf5Reader::numbers_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch<double>(state_->open_attribute(path, name), std::nullopt);
}

std::vector<std::int64_t> Hdf5Reader::integers_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch<std::int64_t>(state_->open_attribute(path, name), std::nullopt);
}

std::vector<std::string> Hdf5Reader::texts_attribute(const std::string& path, const std::string& name) const {
  return state_->fetch_texts(state_->open_attribute(path, name), false);
}

}  // namespace gonogo
