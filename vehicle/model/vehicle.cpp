#include "vehicle/model/vehicle.h"

#include <algorithm>

#include "base/error.h"

namespace gonogo::vehicle {

double Curve::operator()(double x) const {
  GONOGO_ASSERT(!at.empty());
  if (x <= at.front()) return value.front();
  if (x >= at.back()) return value.back();
  const std::size_t high = std::size_t(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  const double share = (x - at[high - 1]) / (at[high] - at[high - 1]);
  return value[high - 1] + share * (value[high] - value[high - 1]);
}

double Spring::push(double length) const {
  double result = force.empty() ? 0 : force(length);
  if (stop.empty()) return result;
  if (length < shortest) result += stop(shortest - length);
  if (length > longest) result -= stop(length - longest);
  return result;
}

namespace {

template <class Item>
const Item& by_name(const std::vector<Item>& items, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  GONOGO_ASSERT(found != items.end());
  return *found;
}

}  // namespace

const Suspension& find_suspension(const Vehicle& v, const std::string& name) { return by_name(v.suspension, name); }
const Wheel& find_wheel(const Vehicle& v, const std::string& name) { return by_name(v.wheel, name); }

}  // namespace gonogo::vehicle
