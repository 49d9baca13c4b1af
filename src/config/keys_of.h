// Tables of keys that fill a struct. A key that names a member is read into it and has the member's default. Other keys
// are left to the reader.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "config/fields.h"
#include "config/keys.h"

namespace aurasim::config {

template <class T>
struct KeyOf {
  Key key;
  std::function<void(const Field&, T&)> store;  ///< empty: the key is left to the reader

  KeyOf(Key plain) : key(std::move(plain)) {}
  KeyOf(Key of_member, std::function<void(const Field&, T&)> into)
      : key(std::move(of_member)), store(std::move(into)) {}

  KeyOf usual(std::string yaml) && { return {std::move(key).usual(std::move(yaml)), std::move(store)}; }
  KeyOf otherwise(std::string words) && { return {std::move(key).otherwise(std::move(words)), std::move(store)}; }
};

template <class T>
class KeysOf : public KeyTable {
 public:
  KeysOf(std::string_view its_title, std::string_view its_about, std::vector<KeyOf<T>> rows,
         std::vector<std::string_view> exactly_one_of = {}) {
    title = its_title;
    about = its_about;
    one_of = std::move(exactly_one_of);
    for (KeyOf<T>& row : rows) {
      keys.push_back(std::move(row.key));
      stores_.push_back(std::move(row.store));
    }
  }

  /// Reads the whole map, if it is given, into the members that its keys name.
  void read(const Field& field, T& object) const {
    if (!field.given()) return;
    const Fields fields(field, *this);
    read_members(fields, object);
    fields.close();
  }

  /// Reads the members that the keys name. For readers that also read other keys of the map.
  void read_members(const Fields& fields, T& object) const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!stores_[i]) continue;
      const Field field = fields[keys[i].name];
      if (field.given() || field.required()) stores_[i](field, object);
    }
  }

 private:
  std::vector<std::function<void(const Field&, T&)>> stores_;  ///< one for each of `keys`
};

template <class M>
struct IsOptional : std::false_type {};
template <class M>
struct IsOptional<std::optional<M>> : std::true_type {};

/// Reads the value of `field`; nothing if it is invalid.
template <class M>
std::optional<M> value_of_field(const Field& field) {
  if constexpr (std::is_same_v<M, double>) {
    return field.number();
  } else if constexpr (std::is_same_v<M, bool>) {
    return field.flag();
  } else if constexpr (std::is_enum_v<M>) {
    return field.choice<M>();
  } else if constexpr (std::is_integral_v<M>) {
    const auto value = field.integer();
    return value ? std::optional(static_cast<M>(*value)) : std::nullopt;
  } else if constexpr (std::is_same_v<M, core::Vec3>) {
    return field.vec3();
  } else if constexpr (std::is_same_v<M, std::vector<std::string>>) {
    M texts;
    for (const Field& item : field.items()) {
      if (auto text = item.text()) texts.push_back(std::move(*text));
    }
    return texts;
  } else {
    static_assert(std::is_same_v<M, std::string>);
    if (field.value().kind == Value::Kind::kText) return field.text();
    const Word* word = field.word();
    return word ? std::optional(std::string(word->name)) : std::nullopt;
  }
}

/// A member's default as YAML; empty if it has none.
template <class M>
std::string yaml_text(const M& member, const Value& value) {
  if constexpr (std::is_enum_v<M>) {
    for (const Word& word : value.words) {
      if (word.meaning == static_cast<std::int64_t>(member)) return std::string(word.name);
    }
    return "";
  } else if constexpr (std::is_same_v<M, double>) {
    return std::isfinite(member) ? fmt::format("{}", member) : "";
  } else if constexpr (std::is_same_v<M, core::Vec3>) {
    return fmt::format("[{}, {}, {}]", member.x(), member.y(), member.z());
  } else if constexpr (IsOptional<M>::value) {
    return member ? yaml_text(*member, value) : "";
  } else if constexpr (std::is_same_v<M, std::vector<std::string>>) {
    std::string texts;
    for (const std::string& text : member) texts += fmt::format("{}\"{}\"", texts.empty() ? "" : ", ", text);
    return member.empty() ? "" : "[" + texts + "]";
  } else {
    return fmt::format("{}", member);
  }
}

template <class T, class M>
std::function<void(const Field&, T&)> into(M T::*member) {
  return [member](const Field& field, T& object) {
    if constexpr (IsOptional<M>::value) {
      object.*member = value_of_field<typename M::value_type>(field);  // stays empty for a word such as auto
    } else {
      if (auto value = value_of_field<M>(field)) object.*member = std::move(*value);
    }
  };
}

template <class T, class M>
KeyOf<T> optional(std::string_view name, M T::*member, Value value, std::string_view meaning) {
  std::string usual = yaml_text(T{}.*member, value);
  return {optional(name, std::move(value), meaning).usual(std::move(usual)), into(member)};
}

template <class T, class M>
KeyOf<T> required(std::string_view name, M T::*member, Value value, std::string_view meaning) {
  return {required(name, std::move(value), meaning), into(member)};
}

/// Key of a map that fills a member which is a struct itself.
template <class T, class M>
KeyOf<T> optional(std::string_view name, M T::*member, const KeysOf<M>& (*table)(), std::string_view meaning) {
  return {optional(name, map(table), meaning),
          [member, table](const Field& field, T& object) { table().read(field, object.*member); }};
}

}  // namespace aurasim::config
