// Names of the solvers in launch files and results.
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "physics/settings.h"

namespace aurasim::physics {

inline constexpr std::array<std::pair<Solver, std::string_view>, 2> kSolverNames = {
    {{Solver::kSequentialImpulse, "sequential_impulse"}, {Solver::kSoftStep, "soft_step"}}};

inline std::string_view name_of(Solver solver) { return kSolverNames[static_cast<std::size_t>(solver)].second; }

/// The solver of this name. Throws std::invalid_argument if there is none.
inline Solver solver_named(std::string_view name) {
  for (const auto& [solver, its_name] : kSolverNames) {
    if (its_name == name) return solver;
  }
  throw std::invalid_argument("there is no solver \"" + std::string(name) + "\"");
}

}  // namespace aurasim::physics
