// Manifolds of a pair that get their points from elsewhere: from a hand-off, or from packed contacts.
#pragma once

#include <vector>

#include "physics/contact_cache.h"

struct btBroadphasePair;
struct btDispatcherInfo;

namespace aurasim::physics {

class Dispatcher;

/// Makes the manifolds of a pair, even if both bodies sleep, empties them, and lists them in `result`. If nobody is
/// awake, they do not outlive the next collision detection.
void make_manifolds(btBroadphasePair& pair, Dispatcher& dispatcher, const btDispatcherInfo& info,
                    std::vector<PartManifold>& result);

}  // namespace aurasim::physics
