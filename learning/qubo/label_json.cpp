#include "learning/qubo/label_json.h"

namespace gonogo::learning {

Json labels_json(const std::vector<Label>& labels) {
  Json list = Json::array();
  for (const Label& label : labels) std::visit([&](const auto& value) { list.push_back(Json(value)); }, label);
  return list;
}

std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count) {
  std::vector<Label> labels;
  for (const Json& item : reader.list(key)) {
    if (item.is_string())
      labels.emplace_back(item.string());
    else if (item.is_integer())
      labels.emplace_back(reader.as_integer(item, key, INT64_MIN / 2, INT64_MAX / 2));
    else
      reader.fail(key, "expected texts or whole numbers, found " + item.dump() + "; relabel the variables");
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
