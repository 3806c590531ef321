#include "pipeline/map/page/page.h"

#include <zlib.h>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::map {

namespace {

/// Low bytes first, then high bytes.
std::string planes(const std::vector<std::uint16_t>& value, int bits) {
  std::string bytes;
  bytes.reserve(value.size() * std::size_t(bits / 8));
  for (int shift = 0; shift < bits; shift += 8)
    for (const std::uint16_t v : value) bytes.push_back(char((v >> shift) & 255));
  return bytes;
}

std::string deflated(const std::string& bytes, int level) {
  uLongf size = compressBound(uLong(bytes.size()));
  std::string out(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size()), level);
  if (status != Z_OK) throw DeviceError("page: zlib could not compress (status " + std::to_string(status) + ")");
  out.resize(size);
  return out;
}

}  // namespace

std::vector<std::uint16_t> filtered(const Blob& blob, BlobFilter filter) {
  const std::uint32_t mask = (1u << blob.bits) - 1;
  const auto& v = blob.value;
  std::vector<std::uint16_t> out(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const bool has_left = i % blob.width != 0, has_up = i >= blob.width;
    const std::uint32_t left = has_left ? v[i - 1] : 0, up = has_up ? v[i - blob.width] : 0;
    const std::uint32_t corner = has_left && has_up ? v[i - blob.width - 1] : 0;
    std::uint32_t expected = 0;
    if (filter == BlobFilter::left) expected = left;
    if (filter == BlobFilter::plane) expected = left + up - corner;
    if (filter == BlobFilter::mean) expected = (left + up) / 2;
    out[i] = std::uint16_t((v[i] - expected) & mask);
  }
  return out;
}

namespace {

/// Pieces of the bytes at equal distances, by which filters are compared.
std::string sample_of(const std::string& bytes) {
  constexpr std::size_t pieces = 8, piece = 8192;
  if (bytes.size() <= 2 * pieces * piece) return bytes;
  std::string sample;
  for (std::size_t k = 0; k < pieces; ++k) sample += bytes.substr(k * (bytes.size() - piece) / (pieces - 1), piece);
  return sample;
}

}  // namespace

std::string blob_element(const Blob& blob) {
  GONOGO_ASSERT(blob.bits == 8 || blob.bits == 16);
  constexpr int fastest = 1, usual = 4;  // 6 takes twice the time and makes pages 3 % smaller
  std::string best;
  std::size_t best_size = SIZE_MAX;
  BlobFilter best_filter = BlobFilter::none;
  for (const BlobFilter filter : {BlobFilter::none, BlobFilter::left, BlobFilter::plane, BlobFilter::mean}) {
    std::string bytes = planes(filtered(blob, filter), blob.bits);
    const std::size_t size = deflated(sample_of(bytes), fastest).size();
    if (size >= best_size) continue;
    best = std::move(bytes);
    best_size = size;
    best_filter = filter;
  }
  return "<script type=\"application/x-gonogo\" id=\"" + blob.name + "\" data-bits=\"" + std::to_string(blob.bits) +
         "\" data-width=\"" + std::to_string(blob.width) + "\" data-filter=\"" + std::to_string(int(best_filter)) +
         "\">" + base64(deflated(best, usual)) + "</script>\n";
}

std::string script_safe(const Json& json) {
  std::string out;
  for (const char c : json.dump()) {
    if (c == '<')
      out += "\\u003c";
    else if (c == '>')
      out += "\\u003e";
    else if (c == '&')
      out += "\\u0026";
    else
      out += c;
  }
  return out;
}

std::string page_file(const Json& meta, const std::vector<Blob>& blobs) {
  std::string elements;
  for (const Blob& blob : blobs) elements += blob_element(blob);
  const std::pair<const char*, std::string> parts[] = {
      {"{{css}}", page_css()}, {"{{meta}}", script_safe(meta)}, {"{{blobs}}", elements}, {"{{js}}", page_js()}};
  const std::string& html = page_html();
  std::string out;
  std::size_t from = 0;
  for (const auto& [mark, text] : parts) {  // in the order in which they stand in the file
    const std::size_t at = html.find(mark, from);
    GONOGO_ASSERT(at != std::string::npos);
    out += html.substr(from, at - from) + text;
    from = at + std::string(mark).size();
  }
  return out + html.substr(from);
}

}  // namespace gonogo::map
