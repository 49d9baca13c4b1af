// How large auras are at equal tolerances: figures 5.21, 5.28 and 5.35 of the thesis, with ours beside them.
#pragma once

#include "lab/conditions.h"

namespace aurasim::lab {

/// Distance between two bounding spheres, in metres, at which the bodies have to share a host when they fly at each
/// other at top speed. The other body's place is taken from an aura K steps old.
double head_on_reach_m(AuraChoice choice, const Conditions& conditions);

}  // namespace aurasim::lab
