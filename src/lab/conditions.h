// Conditions of a trial: the promised values (tolerances) and the real ones. The series of the thesis (section 5.2.3)
// vary one of the three real values and hold the other two at their tolerances.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/aura.h"
#include "core/protocol.h"
#include "core/sync_mode_names.h"

namespace aurasim::lab {

/// Metres per second, seconds, seconds.
struct Tolerances {
  double speed_m_s = 32;
  double latency_s = 0.002;
  double frame_s = 0.015;
};

/// The auras of core, and `kTight` at the size of the thesis's aura.
enum class AuraChoice : std::uint8_t { kNone, kThesis, kTight, kTightAtThesisSize, kSwept };

/// How the nodes of a trial are set up. The control is one node.
struct Variant {
  AuraChoice aura = AuraChoice::kSwept;
  core::SyncMode sync = core::SyncMode::kBounded;
  bool central = false;

  friend bool operator==(const Variant&, const Variant&) = default;
};

struct Conditions {
  Tolerances promised;
  double speed_m_s = 32;  ///< of each of the two bodies
  double latency_s = 0.002;
  double frame_s = 0.015;  ///< longest frame of a node; the shortest is a tenth less
  double loss = 0;         ///< probability that a datagram is lost
  int substeps = 1;
};

enum class Factor : std::uint8_t { kSpeed, kLatency, kFrame, kLoss };

/// One factor varied over `values` (m/s, s, s, share), with the tolerance of that factor.
struct Series {
  Factor factor{};
  double tolerance = 0;
  std::vector<double> values;
};

/// The nine series of the thesis.
std::vector<Series> thesis_series();
/// Packet loss from 0 to 20% (thesis section 5.2.5).
Series loss_series();
/// `count` values of the series, evenly spread, the largest among them.
Series thinned(const Series& series, std::size_t count);

Conditions conditions_at(const Series& series, double value, int substeps);
bool within_tolerance(const Series& series, double value);

/// K of docs/design.md, "Time and lookahead".
int lookahead(const Tolerances& promised);
core::AuraRules rules_for(AuraChoice choice, const Conditions& conditions);
/// Extra distance of an aura beyond the bounding sphere, eq. 3.4 or docs/design.md, "The aura and its reach"; 0
/// for kNone and kSwept. Metres.
double aura_reach_m(AuraChoice choice, const Conditions& conditions);

inline constexpr double kStep_s = 1.0 / 60;

std::string_view name_of(AuraChoice aura);
std::string_view name_of(Factor factor);
/// "speed_32m_s", "latency_2ms", "frame_8.33ms", "loss".
std::string name_of(const Series& series);
/// A value as the files and figures show it: m/s, ms, ms, percent.
double shown(Factor factor, double value);

}  // namespace aurasim::lab
