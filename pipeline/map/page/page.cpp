#include "pipeline/map/page/page.h"

#include <algorithm>

#include "base/error.h"
#include "base/format.h"
#include "terrain/raster/file/deflate.h"

namespace gonogo::map {

namespace {

/// Difference of value i from its prediction, modulo 2^bits.
std::uint16_t rest_of(const Blob& blob, BlobFilter filter, std::size_t i) {
  const auto& v = blob.value;
  const bool has_left = i % blob.width != 0, has_up = i >= blob.width;
  const std::uint32_t left = has_left ? v[i - 1] : 0, up = has_up ? v[i - blob.width] : 0;
  const std::uint32_t corner = has_left && has_up ? v[i - blob.width - 1] : 0;
  std::uint32_t expected = 0;
  if (filter == BlobFilter::left) expected = left;
  if (filter == BlobFilter::plane) expected = left + up - corner;
  if (filter == BlobFilter::mean) expected = (left + up) / 2;
  return std::uint16_t((v[i] - expected) & ((1u << blob.bits) - 1));
}

/// Values as bytes: the low ones first, then the high ones.
std::string planes(const std::vector<std::uint16_t>& value, int bits) {
  std::string bytes;
  bytes.reserve(value.size() * std::size_t(bits / 8));
  for (int shift = 0; shift < bits; shift += 8)
    for (const std::uint16_t v : value) bytes.push_back(char((v >> shift) & 255));
  return bytes;
}

std::string packed(const std::vector<std::uint16_t>& value, int bits, int level) {
  const std::string bytes = planes(value, bits);
  return terrain::deflated(bytes.data(), bytes.size(), level);
}

/// Pieces of the filtered blob at equal distances, by which filters are compared.
std::vector<std::uint16_t> sample_of(const Blob& blob, BlobFilter filter) {
  constexpr std::size_t pieces = 8, piece = 4096;
  const std::size_t count = blob.value.size();
  if (count <= 2 * pieces * piece) return filtered(blob, filter);
  std::vector<std::uint16_t> sample;
  for (std::size_t k = 0; k < pieces; ++k)
    for (std::size_t n = 0; n < piece; ++n)
      sample.push_back(rest_of(blob, filter, k * (count - piece) / (pieces - 1) + n));
  return sample;
}

BlobFilter best_filter(const Blob& blob) {
  constexpr int fastest = 1;
  BlobFilter best = BlobFilter::none;
  std::size_t least = SIZE_MAX;
  for (const BlobFilter filter : {BlobFilter::none, BlobFilter::left, BlobFilter::plane, BlobFilter::mean}) {
    const std::size_t size = packed(sample_of(blob, filter), blob.bits, fastest).size();
    if (size >= least) continue;
    best = filter;
    least = size;
  }
  return best;
}

}  // namespace

std::vector<std::uint16_t> filtered(const Blob& blob, BlobFilter filter) {
  std::vector<std::uint16_t> out(blob.value.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = rest_of(blob, filter, i);
  return out;
}

std::string blob_element(const Blob& blob) {
  GONOGO_ASSERT(blob.bits == 8 || blob.bits == 16);
  constexpr int usual = 4;
  const BlobFilter filter = best_filter(blob);
  return "<script type=\"application/x-gonogo\" id=\"" + blob.name + "\" data-bits=\"" + std::to_string(blob.bits) +
         "\" data-width=\"" + std::to_string(blob.width) + "\" data-filter=\"" + std::to_string(int(filter)) + "\">" +
         base64(packed(filtered(blob, filter), blob.bits, usual)) + "</script>\n";
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
