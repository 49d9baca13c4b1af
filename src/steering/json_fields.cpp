#include "steering/json_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace aurasim::steering {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestShown = 120;
constexpr std::size_t kMostShown = 8;  ///< numbers of a list
constexpr std::string_view kNameOrNumber = "the name or number of a static";

std::string shown_text(const std::string& text) {
  const bool is_long = text.size() > kLongestShown;
  const Json cut = is_long ? text.substr(0, kLongestShown) + "..." : text;
  return cut.dump(-1, ' ', true, Json::error_handler_t::replace);
}

std::string below(std::string_view path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

}  // namespace

std::string shown(double value) { return fmt::format("{:g}", value); }
std::string shown(const core::Vec3& value) {
  return fmt::format("[{:g}, {:g}, {:g}]", value.x(), value.y(), value.z());
}

std::string shown(const Json& value) {
  if (value.is_null()) return "nothing";
  if (value.is_string()) return shown_text(value.get_ref<const std::string&>());
  if (value.is_number_float()) return shown(value.get<double>());
  if (value.is_object()) return "an object";
  if (!value.is_array()) return value.dump();
  if (value.size() > kMostShown) return fmt::format("a list of {}", value.size());
  std::string list;
  for (const Json& element : value) {
    const bool is_list = element.is_array();
    list += (list.empty() ? "" : ", ") + (is_list ? "a list" : element.is_null() ? "null" : shown(element));
  }
  return "[" + list + "]";
}

void refuse(std::string_view field, std::string_view found, std::string_view allowed) {
  throw BadAsk(fmt::format("{}: found {}, allowed: {}", field, found, allowed));
}

const Json& member(const Json& of, std::string_view key) {
  static const Json none;
  if (!of.is_object()) return none;
  const auto found = of.find(key);
  return found == of.end() ? none : *found;
}

void only(const Json& of, std::initializer_list<std::string_view> keys) {
  for (const auto& [key, value] : of.items()) {
    if (std::ranges::find(keys, key) != keys.end()) continue;
    throw BadAsk(fmt::format("{}: unknown field; allowed: {}", shown_text(key), fmt::join(keys, ", ")));
  }
}

bool is_list(const Json& value, std::size_t size) {
  return value.is_array() && value.size() == size && std::ranges::all_of(value, [](const Json& number) {
           return number.is_number() && std::isfinite(number.get<double>());
         });
}

double number_of(const Json& of, std::string_view key, double low, double high, std::string_view path) {
  const Json& found = member(of, key);
  const double value = found.is_number() ? found.get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(value >= low && value <= high)) refuse(below(path, key), shown(found), fmt::format("{:g} to {:g}", low, high));
  return value;
}

std::uint64_t whole_of(const Json& of, std::string_view key, std::uint64_t low, std::uint64_t high,
                       std::string_view path) {
  const Json& found = member(of, key);
  // A number that is not negative may be held as a signed one, where a program has made the JSON.
  const bool is_whole = found.is_number_unsigned() || (found.is_number_integer() && found.get<std::int64_t>() >= 0);
  const std::uint64_t value = is_whole ? found.get<std::uint64_t>() : 0;
  if (!is_whole || value < low || value > high) {
    refuse(below(path, key), shown(found), fmt::format("a whole number from {} to {}", low, high));
  }
  return value;
}

bool flag_of(const Json& of, std::string_view key) {
  const Json& found = member(of, key);
  if (!found.is_null() && !found.is_boolean()) refuse(key, shown(found), "true or false");
  return found.is_boolean() && found.get<bool>();
}

std::string text_of(const Json& of, std::string_view key, std::size_t longest) {
  const Json& found = member(of, key);
  const auto* const text = found.get_ptr<const std::string*>();
  if (text == nullptr || text->empty() || text->size() > longest) {
    refuse(key, shown(found), fmt::format("a text of 1 to {} bytes", longest));
  }
  return *text;
}

core::Vec3 vector_of(const Json& of, std::string_view key) {
  const Json& v = member(of, key);
  if (!is_list(v, 3)) refuse(key, shown(v), "three finite numbers");
  return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

core::Quat rotation_of(const Json& of, std::string_view key) {
  const Json& q = member(of, key);
  constexpr std::string_view kAllowed = "a quaternion w x y z of finite numbers, e.g. 1 0 0 0";
  if (!is_list(q, 4)) refuse(key, shown(q), kAllowed);
  const core::Quat rotation(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(), q[3].get<double>());
  if (!(rotation.norm() > 1e-6 && rotation.norm() < 1e6)) refuse(key, shown(q), kAllowed);
  return rotation.normalized();
}

core::StaticId static_of(const Json& value, const core::Scene& scene, std::string_view field) {
  if (const auto* const name = value.get_ptr<const std::string*>()) {
    if (const auto found = core::find_static(scene, *name)) return *found;
    std::uint32_t id = 0;
    const auto [end, error] = std::from_chars(name->data(), name->data() + name->size(), id);
    const bool is_number = error == std::errc() && end == name->data() + name->size();
    if (!is_number) refuse(field, shown(value), kNameOrNumber);
    return core::StaticId{id};
  }
  const bool is_whole = value.is_number_unsigned() || (value.is_number_integer() && value.get<std::int64_t>() >= 0);
  if (!is_whole || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    refuse(field, shown(value), kNameOrNumber);
  }
  return core::StaticId{static_cast<std::uint32_t>(value.get<std::uint64_t>())};
}

}  // namespace aurasim::steering
