#include "base/hdf5/handle.h"

#include <algorithm>

#include "base/files/file.h"

namespace gonogo::hdf5 {
namespace {

const std::string kSealHead = "\ngonogo seal XXH3-128 ";
const std::size_t kSealSize = kSealHead.size() + 32 + 1;

herr_t keep_deepest(unsigned depth, const H5E_error2_t* error, void* target) {
  if (depth == 0 && error->desc) *static_cast<std::string*>(target) = error->desc;
  return 0;
}

}  // namespace

void quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

std::string take_error() {
  std::string message;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_deepest, &message);
  H5Eclear2(H5E_DEFAULT);
  return message.empty() ? "unknown reason" : message;
}

template <>
ElementType element_type<float>() {
  return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, "32-bit numbers"};
}
template <>
ElementType element_type<double>() {
  return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, "64-bit numbers"};
}
template <>
ElementType element_type<std::int32_t>() {
  return {H5T_STD_I32LE, H5T_NATIVE_INT32, "32-bit signed integers"};
}
template <>
ElementType element_type<std::int64_t>() {
  return {H5T_STD_I64LE, H5T_NATIVE_INT64, "64-bit signed integers"};
}
template <>
ElementType element_type<std::uint8_t>() {
  return {H5T_STD_U8LE, H5T_NATIVE_UINT8, "8-bit unsigned integers"};
}
template <>
ElementType element_type<std::uint32_t>() {
  return {H5T_STD_U32LE, H5T_NATIVE_UINT32, "32-bit unsigned integers"};
}
template <>
ElementType element_type<std::uint64_t>() {
  return {H5T_STD_U64LE, H5T_NATIVE_UINT64, "64-bit unsigned integers"};
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (end > begin) parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string seal_of(std::string_view content) { return kSealHead + content_hash(content) + "\n"; }

std::string_view without_seal(std::string_view file) {
  if (file.size() < kSealSize) return file;
  const std::string_view tail = file.substr(file.size() - kSealSize);
  return tail.substr(0, kSealHead.size()) == kSealHead ? file.substr(0, file.size() - kSealSize) : file;
}

std::string to_text(const Shape& shape) {
  if (shape.empty()) return "scalar";
  std::string text;
  for (const std::size_t length : shape) text += (text.empty() ? "" : " x ") + std::to_string(length);
  return text;
}

std::size_t element_count(const Shape& shape) {
  std::size_t count = 1;
  for (const std::size_t length : shape) count *= length;
  return count;
}

}  // namespace gonogo::hdf5
