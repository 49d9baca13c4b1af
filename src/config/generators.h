// Bodies in regular formations.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostGenerators = 10'000;

/// Keys of a generator: exactly one kind of formation.
const KeyTable& generator_keys();

void read_generators(const Field& field, SceneDraft& draft);

}  // namespace aurasim::config
