#include "learning/qubo/json.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::learning {
namespace {

void append_unit(std::string& out, unsigned unit) { out += line("\\u%04x", unit); }

/// Code point that starts at text[at]; moves `at` past it. The text is valid UTF-8: the JSON parser checked it.
unsigned next_code_point(const std::string& text, std::size_t& at) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? unsigned(static_cast<unsigned char>(text[k])) : 0u; };
  const unsigned lead = byte(at);
  const int more = lead < 0x80 ? 0 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
  unsigned code = more == 0 ? lead : lead & (0x3Fu >> more);
  for (int k = 1; k <= more; ++k) code = code << 6 | (byte(at + std::size_t(k)) & 0x3F);
  at += std::size_t(more) + 1;
  return code;
}

void append_text(std::string& out, const std::string& text) {
  out += '"';
  for (std::size_t at = 0; at < text.size();) {
    const unsigned code = next_code_point(text, at);
    switch (code) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      case '\t':
        out += "\\t";
        break;
      case '\b':
        out += "\\b";
        break;
      case '\f':
        out += "\\f";
        break;
      default:
        if (code >= 0x10000) {
          append_unit(out, 0xD800 + ((code - 0x10000) >> 10));
          append_unit(out, 0xDC00 + ((code - 0x10000) & 0x3FF));
        } else if (code < 0x20 || code >= 0x7F) {
          append_unit(out, code);
        } else {
          out += char(code);
        }
    }
  }
  out += '"';
}

class Writer {
 public:
  explicit Writer(JsonSpaces spaces)
      : comma_(spaces == JsonSpaces::after ? ", " : ","), colon_(spaces == JsonSpaces::after ? ": " : ":") {}

  void write(std::string& out, const Json& json) const {
    if (json.is_null())
      out += "null";
    else if (json.is_bool())
      out += json.boolean() ? "true" : "false";
    else if (json.is_integer())
      out += json.dump();
    else if (json.is_number())
      out += std::isfinite(json.number()) ? python_number(json.number()) : "null";
    else if (json.is_string())
      append_text(out, json.string());
    else if (json.is_array())
      write_list(out, json.items());
    else
      write_object(out, json.members());
  }

 private:
  void write_list(std::string& out, const Json::Array& items) const {
    out += '[';
    for (std::size_t k = 0; k < items.size(); ++k) {
      if (k > 0) out += comma_;
      write(out, items[k]);
    }
    out += ']';
  }
  void write_object(std::string& out, const Json::Object& members) const {
    out += '{';
    for (std::size_t k = 0; k < members.size(); ++k) {
      if (k > 0) out += comma_;
      append_text(out, members[k].first);
      out += colon_;
      write(out, members[k].second);
    }
    out += '}';
  }
  const char *comma_, *colon_;
};

}  // namespace

std::string python_number(double x) {
  GONOGO_ASSERT(std::isfinite(x));
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::scientific).ptr;
  std::string scientific(text, end);
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  if (exponent < -4 || exponent >= 16) return scientific;
  char fixed[64];
  std::string result(fixed, std::to_chars(fixed, fixed + sizeof fixed, x, std::chars_format::fixed).ptr);
  if (result.find('.') == std::string::npos) result += ".0";
  return result;
}

std::string python_json(const Json& json, JsonSpaces spaces) {
  std::string out;
  Writer(spaces).write(out, json);
  return out;
}

Json labels_json(const std::vector<Label>& labels) {
  Json list = Json::array();
  for (const Label& label : labels) {
    if (const auto* tuple = std::get_if<LabelTuple>(&label))
      list.push_back(labels_json(tuple->parts));
    else if (const auto* number = std::get_if<std::int64_t>(&label))
      list.push_back(Json(*number));
    else if (const auto* fraction = std::get_if<double>(&label))
      list.push_back(Json(*fraction));
    else
      list.push_back(Json(std::get<std::string>(label)));
  }
  return list;
}

namespace {

/// Empty where dimod could not have written this label.
std::optional<Label> label_from(const Json& item) {
  if (item.is_string()) return item.string();
  if (item.is_integer())
    return item.number() < 0 || item.unsigned_integer() <= INT64_MAX ? std::optional<Label>(item.integer())
                                                                     : std::nullopt;
  if (item.is_number() && std::isfinite(item.number())) return item.number();
  if (!item.is_array()) return std::nullopt;
  LabelTuple tuple;
  for (const Json& part : item.items()) {
    std::optional<Label> label = label_from(part);
    if (!label) return std::nullopt;
    tuple.parts.push_back(std::move(*label));
  }
  return tuple;
}

}  // namespace

std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count) {
  std::vector<Label> labels;
  for (const Json& item : reader.list(key)) {
    std::optional<Label> label = label_from(item);
    if (!label)
      reader.fail(key, "expected texts, numbers or tuples of them, found " + item.dump() + "; relabel the variables");
    labels.push_back(std::move(*label));
  }
  reader.expect_size(key, labels.size(), count);
  return labels;
}

Vartype vartype_from_json(const JsonReader& reader, const std::string& key) {
  const std::string name = reader.text(key);
  if (name == "BINARY") return Vartype::binary;
  if (name == "SPIN") return Vartype::spin;
  reader.fail(key, "expected \"BINARY\" or \"SPIN\", found \"" + name + "\"");
}

}  // namespace gonogo::learning
