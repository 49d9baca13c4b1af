// Every horizon of the protocol in one place, in steps, by the lookahead K: how far ahead bodies are looked for, how
// long before it counts something has to be known, and how long it is remembered. What a node knows of others is K
// states old, and what it sends takes part in their world K states later: most of it follows from these two.
#pragma once

#include "core/ids.h"

namespace aurasim::core::horizon {

// Hops: the regions through which a chain of pulls can come (docs/design.md, "Who leaves").

/// Four regions meet at a corner of a grid: a pull can come through three others. Looking further ahead than that has
/// made no difference in any run, and costs (docs/decisions/0006-hops.md).
inline constexpr int kMostHops = 3;
/// A cluster goes home only if nothing is expected to meet it for K steps more than an aura looks ahead: that long, the
/// others may act upon auras from before it left. So auras have to be known that much earlier, too.
inline constexpr int kHomewardHops = 1;
/// While ranks change, a chain of pulls may have to come all the way back: each region counts twice. For meetings one
/// step less is enough (docs/decisions/0016-ranks.md).
inline constexpr int kHopsEachWhileRanksChange = 2;
inline constexpr int kFewerStepsWhileRanksChange = 1;

// Looking ahead.

/// A foreign body and one of ours that meet before then have to share a host: our hand-off takes part K states from
/// now, and each further hop takes K more.
constexpr int meeting(int lookahead, int hops) { return hops * lookahead; }
/// Bodies of one host that may touch before then have to move together. Whoever pulls one of them acts upon an aura
/// that is K states old; the state in which it arrives is looked at again.
constexpr int linking(int lookahead, int hops) { return (hops + 1) * lookahead - 1; }
/// Others act upon our auras when these are K states old, and look as far ahead as a meeting.
constexpr int announcing(int lookahead, int hops) { return meeting(lookahead, hops) + lookahead; }
/// The lookahead with which hosts are assigned in state 0: for the first 2K steps nobody has received anything, and
/// what is decided then takes effect 2K later.
constexpr int lookahead_at_start(int lookahead) { return 4 * lookahead; }

/// Between an introduction and the state from which on the two listen to each other: both have received it, and have
/// had half a second, at 60 steps a second, to find each other on the network.
constexpr Step introduction(int lookahead) { return lookahead + 1 + 30; }

// Checking, and computing again.

/// A state is checked so many states later: the others' are here K states later, and whoever joins late has made up its
/// states after K, and published them K - 1 later.
constexpr Step check(int lookahead) { return 2 * lookahead - 1; }
/// States between two cuts.
inline constexpr Step kBetweenCuts = 30;
/// A cut is so much older than the touch that it is to prevent: the pair comes to one host through at most so many
/// pulls, each of which is decided a state after what it follows from is known.
constexpr Step before_touch(int lookahead) { return 2 + kMostHops * (lookahead + 1); }
/// So long after their touch a pair is held together: from then on contacts and auras tell.
constexpr Step together_after_touch(int lookahead) { return 2 * lookahead + 2; }

// Remembering.

/// A body just sent away stays a ghost until the first aura of its new host can have come: there and back.
constexpr Step ghost(int lookahead) { return 2 * lookahead; }
/// An aura is acted upon until it is K states old, and what follows takes effect K states later: until then it binds.
constexpr Step promise(int lookahead) { return 2 * lookahead; }
/// So many states in a row a cluster has to be an island before it goes home: all that was sent because of where it
/// was before has arrived, and has been seen.
constexpr Step homecoming(int lookahead) { return 2 * lookahead + 1; }
/// So long a cluster does not go home before the one that was pulled to it has touched something. A pull comes early by
/// at most the way that both may leave their paths, stated four times as fast as they are (Push::of), through kMostHops
/// regions: 28 K states for two that come together at half of their speed.
constexpr Step pull(int lookahead) { return 40 * lookahead; }
/// A broken promise can spoil what is decided until its messages are replaced: aura, hand-off, and both looks ahead.
constexpr Step blame(int lookahead) { return 6 * lookahead + 2; }
/// States that the collision watch keeps: those in which an arrival can have been under way.
constexpr Step under_way(int lookahead) { return 2 * lookahead + 2; }

// Saying it early enough.

/// Steps before a body appears at which it is announced: long enough for every neighbour to have answered.
constexpr Step birth_notice(int lookahead) { return 4 * lookahead + 2; }
/// Between a command to a whole run and the state that it names: all nodes have received it, also those K ahead.
constexpr Step command_notice(int lookahead) { return 2 * lookahead + 1; }
/// Steps between a claim and the state from which on it counts: everyone has received it, and has looked further ahead
/// for as long as a pull can take.
constexpr Step rank_notice(int lookahead) { return 6 * lookahead + 2; }
/// Before that state everyone looks further ahead: three pulls in a row, the longest chain
/// (docs/decisions/0006-hops.md), and all of it has to be announced before.
constexpr Step before_ranks_change(int lookahead) { return (kMostHops + 1) * lookahead + 1; }
/// After it, the last bodies that went the old way may be under way for so many states.
constexpr Step after_ranks_change(int lookahead) { return lookahead - 1; }
/// Between two claims of one node: everybody remembers two, and is done with the first when the third is made.
constexpr Step between_claims(int lookahead) { return rank_notice(lookahead) + 2 * lookahead; }

}  // namespace aurasim::core::horizon
