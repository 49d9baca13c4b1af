// Reads fields of JSON objects that clients send, with everything checked. Each function throws BadAsk with the field,
// what was found, and what is allowed.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "steering/ask.h"

namespace aurasim::steering {

/// A value as messages show it: on one line, short, in ASCII, whatever it holds. "nothing" for null.
std::string shown(const nlohmann::json& value);
std::string shown(double value);
std::string shown(const core::Vec3& value);

[[noreturn]] void refuse(std::string_view field, std::string_view found, std::string_view allowed);

/// The member `key`; null if there is none, or if `of` is no object.
const nlohmann::json& member(const nlohmann::json& of, std::string_view key);
/// Refuses members other than `keys`.
void only(const nlohmann::json& of, std::initializer_list<std::string_view> keys);
/// True for a list of `size` finite numbers. NaN and infinity arrive as null.
bool is_list(const nlohmann::json& value, std::size_t size);

/// `path`: what the object is called in the refusal; empty: nothing.
double number_of(const nlohmann::json& of, std::string_view key, double low, double high, std::string_view path = {});
/// A whole number. `high`: at most 2^53.
std::uint64_t whole_of(const nlohmann::json& of, std::string_view key, std::uint64_t low, std::uint64_t high,
                       std::string_view path = {});
/// A flag; false if there is none.
bool flag_of(const nlohmann::json& of, std::string_view key);
/// A text of 1 to `longest` bytes.
std::string text_of(const nlohmann::json& of, std::string_view key, std::size_t longest);
core::Vec3 vector_of(const nlohmann::json& of, std::string_view key);
/// A quaternion w x y z of any length but 0, made to length 1.
core::Quat rotation_of(const nlohmann::json& of, std::string_view key);

/// The static that `value` names, or whose number it has. `field`: for the refusal.
core::StaticId static_of(const nlohmann::json& value, const core::Scene& scene, std::string_view field);

}  // namespace aurasim::steering
