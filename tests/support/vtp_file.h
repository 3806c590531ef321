// Reads .vtp files back for tests, written from the format's description alone and sharing nothing with the writer:
// attributes by name, arrays from the appended block by offset.
#pragma once
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/files/file.h"

namespace gonogo::test {

/// Value of an attribute inside one XML tag.
inline std::string xml_attribute(const std::string& tag, const std::string& name) {
  const auto at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) throw std::runtime_error("no attribute " + name + " in " + tag);
  const auto start = at + name.size() + 3;
  return tag.substr(start, tag.find('"', start) - start);
}

/// All tags of this name, in order.
inline std::vector<std::string> xml_tags(const std::string& text, const std::string& name) {
  std::vector<std::string> tags;
  for (auto at = text.find("<" + name + " "); at != std::string::npos; at = text.find("<" + name + " ", at + 1))
    tags.push_back(text.substr(at, text.find('>', at) + 1 - at));
  return tags;
}

struct VtpFile {
  std::int64_t points = 0, vertices = 0, triangles = 0;
  struct Array {
    std::string type;
    int components;
    std::vector<double> values;
  };
  std::map<std::string, Array> array;  // the cells' arrays as "connectivity" and "offsets" of the kind that has any

  const std::vector<double>& values(const std::string& name) const { return array.at(name).values; }
};

template <class T>
std::vector<double> numbers_at(const std::string& raw, std::size_t offset) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, raw.data() + offset, 8);
  if (offset + 8 + bytes > raw.size() || bytes % sizeof(T) != 0) throw std::runtime_error("array runs out of the file");
  std::vector<T> numbers(bytes / sizeof(T));
  if (bytes > 0) std::memcpy(numbers.data(), raw.data() + offset + 8, bytes);
  return {numbers.begin(), numbers.end()};
}

inline VtpFile read_vtp(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const auto appended = text.find("<AppendedData");
  const std::string head = text.substr(0, appended);
  const std::string raw = text.substr(text.find('_', appended) + 1);
  const std::string file = xml_tags(head, "VTKFile").at(0), piece = xml_tags(head, "Piece").at(0);
  if (xml_attribute(file, "type") != "PolyData" || xml_attribute(file, "header_type") != "UInt64" ||
      xml_attribute(file, "byte_order") != "LittleEndian")
    throw std::runtime_error("not the expected kind of file");
  VtpFile v;
  v.points = std::stoll(xml_attribute(piece, "NumberOfPoints"));
  v.vertices = std::stoll(xml_attribute(piece, "NumberOfVerts"));
  v.triangles = std::stoll(xml_attribute(piece, "NumberOfPolys"));
  for (const std::string& tag : xml_tags(head, "DataArray")) {
    const std::string type = xml_attribute(tag, "type"), name = xml_attribute(tag, "Name");
    const std::size_t offset = std::stoull(xml_attribute(tag, "offset"));
    VtpFile::Array a{type, std::stoi(xml_attribute(tag, "NumberOfComponents")), {}};
    a.values = type == "Float32"   ? numbers_at<float>(raw, offset)
               : type == "Float64" ? numbers_at<double>(raw, offset)
               : type == "Int32"   ? numbers_at<std::int32_t>(raw, offset)
                                   : numbers_at<std::int64_t>(raw, offset);
    v.array[name] = a;
  }
  return v;
}

/// Times and file names of a .pvd, in order.
inline std::vector<std::pair<double, std::string>> read_pvd(const std::filesystem::path& path) {
  std::vector<std::pair<double, std::string>> frames;
  const std::string text = read_file(path);
  if (text.find("</VTKFile>") == std::string::npos) throw std::runtime_error("the .pvd has no end");
  for (const std::string& tag : xml_tags(text, "DataSet"))
    frames.emplace_back(std::stod(xml_attribute(tag, "timestep")), xml_attribute(tag, "file"));
  return frames;
}

}  // namespace gonogo::test
