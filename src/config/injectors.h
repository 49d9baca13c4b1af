// Injectors of a scene: each creates bodies over time, in one volume or in several that share its rate and count.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostInjectors = 10'000;

const KeyTable& injector_keys();

/// Ids of injected bodies follow those of the bodies: call after number_bodies().
void read_injectors(const Field& field, SceneDraft& draft);

/// One more, of which only the ids are left to say.
void add_injector(core::Injector injector, const Field& blame, SceneDraft& draft);

}  // namespace aurasim::config
