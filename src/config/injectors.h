// Reads injectors of a scene. Each creates bodies over time, in one volume or in several that share its rate and count.
#pragma once

#include "config/scene_draft.h"

namespace aurasim::config {

inline constexpr std::size_t kMostInjectors = 10'000;

const KeyTable& injector_keys();

/// Reads all injectors. Call it after number_bodies(), because ids of injected bodies follow those of the bodies.
void read_injectors(const Field& field, SceneDraft& draft);

/// Adds one more injector, whose ids are set here.
void add_injector(core::Injector injector, const Field& blame, SceneDraft& draft);

}  // namespace aurasim::config
