// The JSON of what a run can be asked (docs/commands.md). The agent validates it; nothing is checked here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <aurasim/client.h>
#include <nlohmann/json.hpp>

namespace aurasim::client {

/// An ask of this kind, for fields to be added.
nlohmann::json ask_json(const char* kind);
nlohmann::json spawn_json(const NewBody& body);
nlohmann::json static_json(const NewStatic& fixed);
nlohmann::json move_json(const std::variant<std::uint32_t, std::string>& fixed, const Vec3& position,
                         const Quaternion& rotation, double duration);
nlohmann::json impulse_json(std::uint64_t body, const Vec3& impulse, const std::optional<Vec3>& point);
nlohmann::json velocity_json(std::uint64_t body, const Vec3& linear, const std::optional<Vec3>& angular);
nlohmann::json regions_json(const std::vector<std::array<double, 4>>& boxes);

}  // namespace aurasim::client
