// Joints that follow others: mimics, gears.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Lets one joint be `offset` and `ratio` times where the other is, in rad or m of its own, by a drive that is stiff
/// for all masses of the model and no stronger than its own, or else the leader's. Indices in Model::joints. Returns
/// why it cannot; empty: it does.
std::string follow(std::size_t follower, std::size_t leader, double ratio, double offset, Model& model);

/// Nothing: there is none.
std::optional<std::size_t> find_joint(const Model& model, std::string_view name);

}  // namespace aurasim::importing
