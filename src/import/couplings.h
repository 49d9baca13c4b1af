// Couples joints that follow others: mimics, gears.
#pragma once

#include "import/model.h"

namespace aurasim::importing {

/// Makes a joint follow a leader: its place is `offset` + `ratio` times the leader's, in rad or m of its own. It is
/// held there by a drive that is stiff for all masses of the model and no stronger than its own drive, or else the
/// leader's. Both are indices in Model::joints. Returns why it cannot; empty: it does.
std::string follow(std::size_t follower, std::size_t leader, double ratio, double offset, Model& model);

/// Returns the index of a joint by its name; nothing: there is none.
std::optional<std::size_t> find_joint(const Model& model, std::string_view name);

}  // namespace aurasim::importing
