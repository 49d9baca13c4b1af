#include "messages/cluster_graph_codec.h"

#include <optional>

#include "aurasim.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {
namespace {

using core::BodyId;
using core::BodyPair;
using core::ClusterGraph;
using Ids = std::vector<std::uint64_t>;

std::optional<WireError> check(const wire::ClusterGraph& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) return error;
  if (const auto error = check_source(in, expected)) return error;
  if (std::max(in.link_a().size(), in.contact_a().size()) > kMaxRows) return WireError::kTooLarge;
  if (in.link_a().size() != in.link_b().size() || in.contact_a().size() != in.contact_b().size()) {
    return WireError::kLength;
  }
  const bool in_range = in.stamp() >= 0 && all_body_ids(in.link_a()) && all_body_ids(in.link_b()) &&
                        all_body_ids(in.contact_a()) && all_body_ids(in.contact_b());
  return in_range ? std::optional<WireError>{} : WireError::kRange;
}

std::vector<BodyPair> pairs_of(const Ids& a, const Ids& b) {
  std::vector<BodyPair> pairs;
  pairs.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) pairs.push_back({static_cast<BodyId>(a[i]), static_cast<BodyId>(b[i])});
  return pairs;
}

void put(const std::vector<BodyPair>& pairs, Ids& a, Ids& b) {
  fill(a, pairs, [](const BodyPair& pair) { return core::value_of(pair.a); });
  fill(b, pairs, [](const BodyPair& pair) { return core::value_of(pair.b); });
}

}  // namespace

void encode(const ClusterGraph& graph, wire::ClusterGraph& out) {
  out.source(core::value_of(graph.source));
  out.version(kProtocolVersion);
  out.generation(graph.generation);
  out.stamp(graph.stamp);
  out.map_version(graph.map_version);
  put(graph.links, out.link_a(), out.link_b());
  put(graph.contacts, out.contact_a(), out.contact_b());
}

Decoded<ClusterGraph> decode(const wire::ClusterGraph& in, const Expected& expected) {
  if (const auto error = check(in, expected)) return *error;
  return ClusterGraph{static_cast<core::RegionId>(in.source()),
                      in.generation(),
                      in.stamp(),
                      in.map_version(),
                      pairs_of(in.link_a(), in.link_b()),
                      pairs_of(in.contact_a(), in.contact_b())};
}

}  // namespace aurasim::messages
