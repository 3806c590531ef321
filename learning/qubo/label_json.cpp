#include "learning/qubo/label_json.h"

#include <algorithm>

#include "learning/qubo/python_json.h"

namespace gonogo::learning {

Json labels_json(const std::vector<Label>& labels) {
  Json list = Json::array();
  for (const Label& label : labels) {
    if (const auto* number = std::get_if<std::int64_t>(&label))
      list.push_back(Json(*number));
    else if (const auto* text = std::get_if<std::string>(&label))
      list.push_back(Json(*text));
    else
      list.push_back(Json::parse(std::get<JsonLabel>(label).text, "label"));
  }
  return list;
}

namespace {

/// Whether dimod could have written this label, or this part of one.
bool is_label(const Json& item) {
  if (item.is_array()) return std::all_of(item.items().begin(), item.items().end(), is_label);
  if (item.is_integer()) return item.number() < 0 || item.unsigned_integer() <= INT64_MAX;
  return item.is_string() || item.is_number();
}

}  // namespace

std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count) {
  std::vector<Label> labels;
  for (const Json& item : reader.list(key)) {
    if (item.is_string())
      labels.emplace_back(item.string());
    else if (item.is_integer() && is_label(item))
      labels.emplace_back(item.integer());
    else if (is_label(item))
      labels.emplace_back(JsonLabel{python_json(item, JsonSpaces::after)});
    else
      reader.fail(key, "expected texts, numbers or tuples of them, found " + item.dump() + "; relabel the variables");
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
