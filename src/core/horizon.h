// Every horizon of the protocol in one place, in steps, by the lookahead K: how far ahead bodies are looked for, how
// early something has to be known, and how long it is remembered. Most follow from two facts: what a node knows of
// others is K states old, and what it sends takes effect in their worlds K states later.
#pragma once

#include "core/ids.h"

namespace aurasim::core::horizon {

// Hops: the regions through which a chain of pulls can come (docs/design.md, "Who leaves").

/// Four regions meet at a corner of a grid: a pull can come through three others. Looking further ahead has made no
/// difference in any run, and costs time (docs/decisions/0006-hops.md).
inline constexpr int kMostHops = 3;
/// A cluster goes home only if no body that stays may touch it for K steps more than clusters look ahead: it would be
/// pulled back at once. Where states are not checked, nothing foreign may be expected to meet it for as long, because
/// the others may act upon auras from before it left; so auras have to be announced K steps earlier, too.
inline constexpr int kHomewardHops = 1;

// Looking ahead.

/// A foreign body and one of ours that may meet within so many steps have to share a host. Our hand-off takes effect K
/// states from now, and each further hop takes K more.
constexpr int meeting(int lookahead, int hops) { return hops * lookahead; }
/// Bodies of one host that may touch within so many steps have to move together. A node that pulls one of them acts
/// upon an aura that is K states old. The state in which the body arrives is looked at again, hence the - 1.
constexpr int linking(int lookahead, int hops) { return (hops + 1) * lookahead - 1; }
/// Our bodies have to be announced so many steps before they may meet others: nodes act upon our auras when these are K
/// states old, and look as far ahead as meeting().
constexpr int announcing(int lookahead, int hops) { return meeting(lookahead, hops) + lookahead; }
/// The lookahead with which hosts are assigned in state 0. For the first 2K steps no node has received anything, and
/// what is decided after them takes effect 2K later.
constexpr int lookahead_at_start(int lookahead) { return 4 * lookahead; }

/// Steps between an introduction and the state from which on the two regions listen to each other. By then both have
/// received it, and have had half a second (at 60 steps a second) to find each other on the network.
constexpr Step introduction(int lookahead) { return lookahead + 1 + 30; }
/// Regions that have been introduced listen to each other for so many states after the last introduction. Longer than
/// an introduction looks ahead, so that those whose bodies come and go are not introduced again and again.
constexpr Step listening(int lookahead) { return 2 * introduction(lookahead); }

// Checking, and computing again.

/// A cluster joins K states after its stamp, and its new host then publishes the K - 1 states that it has made up. So
/// all that a region has to say of a state is published so many states later.
constexpr Step made_up(int lookahead) { return lookahead - 1; }
/// A state is checked so many states later at the latest, because messages of others arrive within K states.
constexpr Step check(int lookahead) { return lookahead + made_up(lookahead); }
/// Number of states from one cut to the next. A redo computes at most so many states more than it has to.
inline constexpr Step kBetweenCuts = 2;
/// Number of states between the older cuts, which are kept for pairs that a redo has not brought together.
inline constexpr Step kBetweenOlderCuts = 15 * kBetweenCuts;
/// A redo goes back to a cut at least so many states before the touch that it has to prevent. In the state of the cut
/// the nodes gather (Protocol::gather), so the pair has one host from the next state on.
inline constexpr Step kBeforeTouch = 1;
/// The next redo for the same pair goes back at least so many states. The pair comes to one host through a pull, which
/// is decided one state after its cause is known. Where it takes more pulls, further redos go back to older cuts.
constexpr Step before_pull(int lookahead) { return 2 + (lookahead + 1); }
/// A redo keeps a pair on one host for so many states after its touch. After that, contacts and auras keep it together.
constexpr Step together_after_touch(int lookahead) { return 2 * lookahead + 2; }

// Remembering.

/// A body just handed over stays a ghost until the first aura of its new host can have arrived: K states there and K
/// back.
constexpr Step ghost(int lookahead) { return 2 * lookahead; }
/// Number of states for which the promise of an aura has to hold: others act upon it until it is K states old, and what
/// they decide takes effect K states later.
constexpr Step promise(int lookahead) { return 2 * lookahead; }
/// A cluster has to be an island for so many states in a row before it goes home. After K states, all that others have
/// sent because of it has arrived. Where states are not checked it waits until what they sent because of its earlier
/// place has been looked at, too.
constexpr Step homecoming(int lookahead, bool checked) { return checked ? lookahead + 1 : 2 * lookahead + 1; }
/// For so many steps a broken promise can spoil decisions: until its auras and hand-offs are replaced, and both looks
/// ahead are over.
constexpr Step blame(int lookahead) { return 6 * lookahead + 2; }
/// Number of past states that the collision watch keeps: those in which an arriving cluster can have been under way.
constexpr Step under_way(int lookahead) { return 2 * lookahead + 2; }

// Announcing early enough.

/// A new body is announced so many steps before it appears: long enough for every neighbour to react.
constexpr Step birth_notice(int lookahead) { return 4 * lookahead + 2; }
/// Steps between a command to a whole run and the state that it names. By then all nodes have received it, also those
/// that are K steps ahead.
constexpr Step command_notice(int lookahead) { return 2 * lookahead + 1; }

}  // namespace aurasim::core::horizon
