// Identifiers and counters. Different kinds of id are different types, so they cannot be swapped by mistake.
#pragma once

#include <cstdint>
#include <type_traits>

namespace aurasim::core {

enum class RegionId : std::uint32_t {};
enum class BodyId : std::uint64_t {};
/// Index of a prototype (shape, mass, material) in the scene; the same on every node.
enum class PrototypeId : std::uint32_t {};
enum class StaticId : std::uint32_t {};
enum class JointId : std::uint32_t {};

/// Tick of the shared simulation time. State n is computed from state n-1; state 0 is the scene as written.
using Step = std::int64_t;
/// How often a body has changed host. The highest epoch owns the body.
using Epoch = std::uint32_t;
/// Counts resets of one run. Messages of another generation are about another world and are refused.
using Generation = std::uint32_t;

template <class Id>
requires std::is_enum_v<Id>
constexpr auto value_of(Id id) { return static_cast<std::underlying_type_t<Id>>(id); }

}  // namespace aurasim::core
