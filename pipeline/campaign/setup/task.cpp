#include "pipeline/campaign/setup/task.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::campaign {

// Every type of trial, in the order of help and messages. Adding one: a file that defines <name>_type(), and a line
// here.
#define GONOGO_TASK_TYPES(TYPE) \
  TYPE(climb)                   \
  TYPE(side_slope)              \
  TYPE(drawbar)                 \
  TYPE(single_wheel)            \
  TYPE(step)                    \
  TYPE(ditch)                   \
  TYPE(crossing)
#define GONOGO_DECLARE(name) const TaskType& name##_type();
GONOGO_TASK_TYPES(GONOGO_DECLARE)
#define GONOGO_ENTRY(name) &name##_type(),

const std::vector<const TaskType*>& task_types() {
  static const std::vector<const TaskType*> types{GONOGO_TASK_TYPES(GONOGO_ENTRY)};
  return types;
}
#undef GONOGO_TASK_TYPES
#undef GONOGO_DECLARE
#undef GONOGO_ENTRY

std::string task_examples() {
  std::vector<std::string> examples;
  for (const TaskType* type : task_types()) examples.push_back(type->example);
  return join_words(examples);
}

namespace {

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  for (const TaskType* type : task_types()) names.push_back(type->name);
  return names;
}

/// Null where there is none of this name.
const TaskType* type_named(const std::string& name) {
  for (const TaskType* type : task_types())
    if (name == type->name) return type;
  return nullptr;
}

std::string allowed(const TaskParameter& p) { return line("between %g and %g", p.allowed.minimum, p.allowed.maximum); }

/// A type's parameter; throws InputError, beginning with `where`, where it has none of this name.
const TaskParameter& parameter_of(const TaskType& type, const std::string& key, const std::string& where) {
  std::vector<std::string> keys;
  for (const TaskParameter& p : type.parameters) {
    if (key == p.key) return p;
    keys.push_back(p.key);
  }
  throw InputError(where + ": " + key + ": trials of type " + type.name + " have no such number; " +
                   (keys.empty() ? "they take none" : "they take: " + join_words(keys)));
}

}  // namespace

bool may_lack(const std::string& type, const std::string& key) {
  const TaskType* named = type_named(type);
  if (!named) return false;  // refused where the task is made
  const TaskParameter& p = parameter_of(*named, key, "trial.task");
  return p.may_lack || p.usual.has_value();
}

double TaskNumbers::operator[](const char* key) const {
  const auto found = find(key);
  GONOGO_ASSERT(found.has_value());
  return *found;
}

std::optional<double> TaskNumbers::find(const char* key) const {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (std::string_view(key) == parameters[i].key) return value[i];
  return {};
}

std::shared_ptr<const TrialTask> make_task(const TaskValues& task, const std::string& where) {
  for (const auto& [key, value] : task.number) {
    const TaskParameter& p = parameter_of(*task.type, key, where);
    if (!p.allowed.contains(value))
      throw InputError(where + ": " + key + ": value " + Json(value).dump() +
                       " is outside the allowed range: " + allowed(p));
  }
  TaskNumbers numbers{task.type->parameters, {}};
  for (const TaskParameter& p : task.type->parameters) {
    const auto given = task.number.find(p.key);
    numbers.value.push_back(given != task.number.end() ? std::optional(given->second) : p.usual);
    if (!numbers.value.back() && !p.may_lack)
      throw InputError(where + ": " + p.key + ": missing; give a number " + allowed(p));
  }
  return task.type->make(numbers);
}

TaskValues read_task(const Config& c, const std::vector<std::string>& open) {
  TaskValues task{type_named(c.choice("type", type_names())), {}};
  for (const TaskParameter& p : task.type->parameters) {
    const bool is_open = std::find(open.begin(), open.end(), p.key) != open.end();
    if (c.has(p.key) || (!p.usual && !p.may_lack && !is_open)) task.number[p.key] = c.number(p.key, p.allowed);
  }
  c.finish();
  return task;
}

std::shared_ptr<const TrialTask> parse_task(const std::string& text) {
  const auto colon = text.find(':');
  const std::string name = text.substr(0, colon);
  TaskValues task{type_named(name), {}};
  if (!task.type) throw InputError("--trial: type: \"" + name + "\" is not one of: " + join_words(type_names()));
  for (std::size_t at = colon; at != std::string::npos && at + 1 < text.size();) {
    const std::size_t next = text.find(',', at + 1), equals = text.find('=', at + 1);
    char* end = nullptr;
    const std::string value =
        equals < next ? text.substr(equals + 1, next == std::string::npos ? next : next - equals - 1) : "";
    const double number = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != 0)
      throw InputError("--trial " + text + ": write it as type:name=number,..., such as step:height_m=0.2,length_m=1");
    task.number[text.substr(at + 1, equals - at - 1)] = number;
    at = next;
  }
  return make_task(task, "--trial");
}

double beyond(double from, double x, double length) {
  const double d = std::fmod(x - from, length);
  return d < 0 ? d + length : d;
}

}  // namespace gonogo::campaign
