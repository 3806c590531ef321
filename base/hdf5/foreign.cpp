#include "base/hdf5/foreign.h"

#include <new>

#include "base/apart.h"
#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"

namespace gonogo::hdf5 {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 64;  // groups within each other; more are a group within itself

std::chrono::milliseconds foreign_time = ApartLimits{}.time;

/// Copies a file, object by object. Only what HDF5 gave as plain values reaches the copy.
class Copier {
 public:
  explicit Copier(const OpenFile& in) : in_(in) {}

  std::string image() {
    copy_group("", 0);
    return out_.image();
  }

 private:
  void copy_group(const std::string& path, int depth) {
    if (depth > kDeepest)
      in_.fail(path, "lies in more than " + std::to_string(kDeepest) +
                         " groups; the file is damaged or a group lies in itself");
    out_.group(path);
    copy_attributes(path);
    for (const std::string& name : in_.members(path)) copy_object(path + "/" + name, depth + 1);
  }

  void copy_object(const std::string& path, int depth) {
    const H5I_type_t kind = kind_of(path);
    if (kind == H5I_GROUP) return copy_group(path, depth);
    try {
      if (kind != H5I_DATASET) in_.fail(path, "is no array and no group, or lies in another file, which is not opened");
      copy_array(path);
    } catch (const InputError& error) {
      leave_out(path, error.what());
    } catch (const std::bad_alloc&) {
      leave_out(path, in_.path.string() + ": " + path + ": takes more memory than is left; the file may be damaged");
    }
    if (kind == H5I_DATASET) copy_attributes(path);
  }

  H5I_type_t kind_of(const std::string& path) const {
    const Handle object(H5Oopen(in_.file.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
    H5Eclear2(H5E_DEFAULT);
    return object.valid() ? H5Iget_type(object.get()) : H5I_BADID;
  }

  void leave_out(const std::string& path, const std::string& why) {
    out_.text(path, "");
    out_.attribute(path, kWhyNot, why);
  }

  void copy_array(const std::string& path) {
    const Source source = in_.open_array(path);
    require_own_values(source);
    const Shape shape = shape_of(source.space.get());
    if (H5Tget_class(source.type.get()) == H5T_STRING) {
      if (shape.empty())
        out_.text(path, in_.fetch_texts(source, true).front());
      else
        out_.texts(path, in_.fetch_texts(source, false));
      return;
    }
    const bool copied = copy_as<double>(path, source, shape) || copy_as<float>(path, source, shape) ||
                        copy_as<std::int32_t>(path, source, shape) || copy_as<std::int64_t>(path, source, shape) ||
                        copy_as<std::uint8_t>(path, source, shape) || copy_as<std::uint32_t>(path, source, shape) ||
                        copy_as<std::uint64_t>(path, source, shape);
    if (!copied) in_.fail(path, "holds " + kind_name(source.type.get()) + ", which nothing here reads");
  }

  template <class T>
  bool copy_as(const std::string& path, const Source& source, const Shape& shape) {
    if (!same_kind(source.type.get(), element_type<T>().stored)) return false;
    out_.array(path, in_.fetch<T>(source, std::nullopt), shape);
    return true;
  }

  void require_own_values(const Source& source) const {
    const Handle layout(H5Dget_create_plist(source.object.get()), H5Pclose);
    if (H5Pget_layout(layout.get()) == H5D_VIRTUAL || H5Pget_external_count(layout.get()) > 0)
      in_.fail(source.where, "has its values in another file, which is not opened; store them in this one");
    if (H5Sget_simple_extent_type(source.space.get()) == H5S_NULL) in_.fail(source.where, "holds no value");
  }

  std::vector<std::string> attributes_of(const std::string& path) const {
    const Handle object(H5Oopen(in_.file.get(), path.empty() ? "/" : path.c_str(), H5P_DEFAULT), H5Oclose);
    std::vector<std::string> names;
    const auto add = [](hid_t, const char* name, const H5A_info_t*, void* target) -> herr_t {
      static_cast<std::vector<std::string>*>(target)->push_back(name);
      return 0;
    };
    if (H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names) < 0)
      in_.fail(path, "its attributes cannot be listed, the file is damaged: " + take_error());
    return names;
  }

  void copy_attributes(const std::string& path) {
    for (const std::string& name : attributes_of(path)) {
      try {
        copy_attribute(path, name);
      } catch (const InputError& error) {
        out_.attribute(path, name, "");
        out_.attribute(path, why_not(name), std::string(error.what()));
      }
    }
  }

  void copy_attribute(const std::string& path, const std::string& name) {
    const Source source = in_.open_attribute(path, name);
    const Shape shape = shape_of(source.space.get());
    if (H5Sget_simple_extent_type(source.space.get()) == H5S_NULL) in_.fail(source.where, "holds no value");
    if (shape.size() > 1) in_.fail(source.where, "has shape " + to_text(shape) + ", a scalar or a list is needed");
    if (H5Tget_class(source.type.get()) == H5T_STRING) {
      const auto texts = in_.fetch_texts(source, shape.empty());
      if (shape.empty())
        out_.attribute(path, name, texts.front());
      else
        out_.attribute(path, name, texts);
    } else if (!copy_numbers<double>(path, name, source) && !copy_numbers<std::int64_t>(path, name, source)) {
      in_.fail(source.where, "holds " + kind_name(source.type.get()) + ", text or numbers of 64 bits are needed");
    }
  }

  template <class T>
  bool copy_numbers(const std::string& path, const std::string& name, const Source& source) {
    if (!same_kind(source.type.get(), element_type<T>().stored)) return false;
    const auto values = in_.fetch<T>(source, std::nullopt);
    if (shape_of(source.space.get()).empty())
      out_.attribute(path, name, values.front());
    else
      out_.attribute(path, name, values);
    return true;
  }

  const OpenFile& in_;
  Hdf5Writer out_;
};

std::string copy_of(const fs::path& path) {
  H5Lunregister(H5L_TYPE_EXTERNAL);  // in this process, which is the child; such links then lead nowhere
  const OpenFile in = OpenFile::of_disk(path);
  try {
    return std::string(without_seal(Copier(in).image()));
  } catch (const DeviceError& error) {  // names and shapes that no new file takes
    throw InputError(path.string() + ": is damaged, as it cannot be copied (" + error.what() + "); make it again");
  }
}

std::string sentence(const fs::path& path, ApartEnd end, const ApartLimits& limits) {
  const std::string what =
      end == ApartEnd::crashed ? "ended the HDF5 library with a crash"
      : end == ApartEnd::out_of_time
          ? line("took the HDF5 library more than %.0f s", double(limits.time.count()) / 1000)
          : line("takes the HDF5 library more than %.0f GiB of memory", double(limits.memory) / double(1 << 30));
  return path.string() + ": " + what +
         ", so that nothing of it was read; it is damaged, so make it again or get a whole copy";
}

/// Limits for a file of this many bytes.
ApartLimits foreign_limits(std::uintmax_t bytes) {
  constexpr double slowest_disk = 5e7;  // [byte/s]
  ApartLimits limits{.time = foreign_time};
  limits.time += std::chrono::milliseconds(std::int64_t(1000 * double(bytes) / slowest_disk));
  limits.memory += 4 * std::size_t(bytes);
  return limits;
}

}  // namespace

OpenFile open_foreign(const fs::path& path) {
  std::error_code ignored;
  const ApartLimits limits = foreign_limits(fs::file_size(path, ignored));
  const ApartResult result = call_apart([&] { return copy_of(path); }, limits);
  if (result.end != ApartEnd::done) throw InputError(sentence(path, result.end, limits));
  if (!result.refusal.empty()) throw InputError(result.refusal);
  return OpenFile::of_memory(path, result.bytes);
}

}  // namespace gonogo::hdf5

void gonogo::set_foreign_time(std::chrono::milliseconds longest) { hdf5::foreign_time = longest; }
