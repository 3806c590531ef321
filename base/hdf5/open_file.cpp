#include "base/hdf5/open_file.h"

#include <algorithm>
#include <atomic>

#include "base/error.h"

namespace gonogo::hdf5 {
namespace {

namespace fs = std::filesystem;

// Locks on a file opened for reading only are refused by some shared filesystems; whole files appear by rename here,
// so that nothing needs them.
void no_locks([[maybe_unused]] hid_t access) {
#if H5_VERSION_GE(1, 12, 1) || (H5_VERSION_GE(1, 10, 7) && !H5_VERSION_GE(1, 12, 0))
  H5Pset_file_locking(access, false, true);
#endif
}

OpenFile opened(const fs::path& path, const std::string& name, const Handle& access) {
  OpenFile in{path, Handle(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose)};
  if (!in.file.valid())
    throw InputError(path.string() + ": is no complete HDF5 file (" + take_error() +
                     "); it was cut short or is of another kind, so make it again");
  return in;
}

/// Number of elements; a damaged shape may name more than any memory holds.
std::optional<std::size_t> count_within(const Shape& shape, std::size_t most) {
  std::size_t count = 1;
  for (const std::size_t length : shape) {
    if (length == 0) return 0;
    if (count > most / length) return std::nullopt;
    count *= length;
  }
  return count;
}

}  // namespace

const char* const kWhyNot = "gonogo: why not";

std::string why_not(const std::string& attribute) { return std::string(kWhyNot) + ": " + attribute; }

bool same_kind(hid_t a, hid_t b) {
  const H5T_class_t kind = H5Tget_class(a);
  if (kind != H5Tget_class(b) || H5Tget_size(a) != H5Tget_size(b)) return false;
  return kind == H5T_FLOAT || (kind == H5T_INTEGER && H5Tget_sign(a) == H5Tget_sign(b));
}

std::string kind_name(hid_t type) {
  const std::string bits = std::to_string(8 * H5Tget_size(type)) + "-bit ";
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return bits + (H5Tget_sign(type) == H5T_SGN_NONE ? "unsigned integers" : "signed integers");
    case H5T_FLOAT:
      return bits + "numbers";
    case H5T_STRING:
      return "text";
    default:
      return "values of another kind";
  }
}

Shape shape_of(hid_t space) {
  std::vector<hsize_t> lengths(std::size_t(std::max(0, H5Sget_simple_extent_ndims(space))));
  H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
  return Shape(lengths.begin(), lengths.end());
}

OpenFile OpenFile::of_disk(const fs::path& path) {
  quiet();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  no_locks(access.get());
  return opened(path, path.string(), access);
}

OpenFile OpenFile::of_memory(const fs::path& path, const std::string& image) {
  static std::atomic<unsigned> count{0};  // files in memory of one name would be one file to HDF5
  quiet();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::size_t increment = std::size_t(1) << 16;
  H5Pset_fapl_core(access.get(), increment, false);
  H5Pset_file_image(access.get(), const_cast<char*>(image.data()), image.size());
  return opened(path, "copy " + std::to_string(++count), access);
}

void OpenFile::fail(const std::string& where, const std::string& message) const {
  throw InputError(path.string() + ": " + (where.empty() ? "/" : where) + ": " + message);
}

bool OpenFile::has(const std::string& name) const {
  std::string at;
  for (const std::string& part : split_path(name)) {
    at += "/" + part;
    if (H5Lexists(file.get(), at.c_str(), H5P_DEFAULT) <= 0) {
      H5Eclear2(H5E_DEFAULT);
      return false;
    }
  }
  return true;
}

std::vector<std::string> OpenFile::members(const std::string& group) const {
  if (!has(group)) fail(group, "this group is missing");
  const Handle handle(H5Gopen2(file.get(), group.empty() ? "/" : group.c_str(), H5P_DEFAULT), H5Gclose);
  if (!handle.valid()) fail(group, "is not a group: " + take_error());
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* target) -> herr_t {
    static_cast<std::vector<std::string>*>(target)->push_back(name);
    return 0;
  };
  if (H5Literate(handle.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
    fail(group, "cannot be listed, the file is damaged: " + take_error());
  std::sort(names.begin(), names.end());
  return names;
}

Source OpenFile::open_array(const std::string& name) const {
  if (!has(name)) fail(name, "is missing; the file was written by another program or for another purpose");
  Source source;
  source.where = name;
  source.object = Handle(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!source.object.valid()) fail(name, "is not a readable array: " + take_error());
  if (H5Aexists(source.object.get(), kWhyNot) > 0)
    throw InputError(fetch_texts(open_attribute(name, kWhyNot), true).front());
  source.type = Handle(H5Dget_type(source.object.get()), H5Tclose);
  source.space = Handle(H5Dget_space(source.object.get()), H5Sclose);
  return source;
}

Source OpenFile::open_attribute(const std::string& path, const std::string& name) const {
  Source source{.is_attribute = true, .where = path + ":" + name};
  if (!has(path)) fail(path, "is missing, so that its attribute '" + name + "' cannot be read");
  const Handle owner(H5Oopen(file.get(), path.empty() ? "/" : path.c_str(), H5P_DEFAULT), H5Oclose);
  source.object = Handle(H5Aopen(owner.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!source.object.valid()) {
    H5Eclear2(H5E_DEFAULT);
    fail(source.where, "this attribute is missing");
  }
  if (H5Aexists(owner.get(), why_not(name).c_str()) > 0)
    throw InputError(fetch_texts(open_attribute(path, why_not(name)), true).front());
  source.type = Handle(H5Aget_type(source.object.get()), H5Tclose);
  source.space = Handle(H5Aget_space(source.object.get()), H5Sclose);
  return source;
}

/// A damaged header must not make us reserve more memory than the file can fill.
void OpenFile::check_storage(const Source& source, std::size_t bytes) const {
  if (source.is_attribute) return;
  const Handle layout(H5Dget_create_plist(source.object.get()), H5Pclose);
  if (H5Pget_layout(layout.get()) != H5D_CONTIGUOUS || bytes == 0) return;
  if (H5Dget_storage_size(source.object.get()) != bytes)
    fail(source.where, "holds fewer bytes than its shape needs; the file is damaged");
}

template <class T>
std::vector<T> OpenFile::fetch(const Source& source, const std::optional<Shape>& expected) const {
  const ElementType type = element_type<T>();
  if (!same_kind(source.type.get(), type.stored))
    fail(source.where, "holds " + kind_name(source.type.get()) + ", " + type.name + " are needed");
  const Shape shape = shape_of(source.space.get());
  if (expected && shape != *expected)
    fail(source.where, "has shape " + to_text(shape) + ", " + to_text(*expected) + " is needed");
  const auto count = count_within(shape, std::vector<T>().max_size());
  if (!count) fail(source.where, "has shape " + to_text(shape) + ", which no memory holds; the file is damaged");
  check_storage(source, *count * sizeof(T));
  std::vector<T> values(*count);
  if (!values.empty() && !source.fetch(type.memory, values.data()))
    fail(source.where, "cannot be read, the file is damaged: " + take_error());
  return values;
}

template std::vector<float> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<double> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<std::int32_t> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<std::int64_t> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<std::uint8_t> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<std::uint32_t> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;
template std::vector<std::uint64_t> OpenFile::fetch(const Source&, const std::optional<Shape>&) const;

std::vector<std::string> OpenFile::fetch_texts(const Source& source, bool scalar) const {
  if (H5Tget_class(source.type.get()) != H5T_STRING || H5Tis_variable_str(source.type.get()) <= 0)
    fail(source.where, "holds " + kind_name(source.type.get()) + ", text of variable length is needed");
  const Shape shape = shape_of(source.space.get());
  if (shape.size() != (scalar ? 0u : 1u))
    fail(source.where, "has shape " + to_text(shape) + ", a " + (scalar ? "scalar" : "list") + " is needed");
  if (!count_within(shape, std::vector<char*>().max_size()))
    fail(source.where, "has shape " + to_text(shape) + ", which no memory holds; the file is damaged");
  std::vector<char*> raw(element_count(shape), nullptr);
  const Handle type = text_type();
  if (!raw.empty() && !source.fetch(type.get(), raw.data()))
    fail(source.where, "cannot be read, the file is damaged: " + take_error());
  std::vector<std::string> values;
  for (const char* text : raw) values.emplace_back(text ? text : "");
  if (!raw.empty()) H5Dvlen_reclaim(type.get(), source.space.get(), H5P_DEFAULT, raw.data());
  return values;
}

}  // namespace gonogo::hdf5
