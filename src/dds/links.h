// The endpoints by which a region exchanges messages with others (topics aura and migration). Everybody
// discovers every endpoint of everybody, so a region has one reader for each topic, whatever the number of regions that
// are near it. Only what is for one receiver has a writer of its own for each, and regions that come and go have a
// reader each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.h"
#include "dds/endpoints.h"
#include "dds/watch.h"

namespace aurasim::dds {

/// A region's endpoints for one other region, and what is known of that one.
struct Link {
  core::RegionId region{};
  const Reader* auras = nullptr;  ///< the reader that hears its batches
  bool is_first = true;           ///< has been there from the beginning, at the other region, too
  /// That to a first region is there from the beginning. Bodies seldom go to others, so those are made when needed.
  std::optional<Writer> migration_writer;

  std::uint64_t match = 0;  ///< RemoteWriter::order of the region's aura writer that we know; 0: none yet
  bool lost = false;
  bool met = false;           ///< has been matched once
  std::uint64_t refused = 0;  ///< samples of this region that were refused
};

/// Used by one thread. The domain must outlive it.
class Links {
 public:
  /// Throws DdsError when an endpoint cannot be created. `life`: see TransportSettings.
  Links(Domain& domain, core::RegionId self, core::Generation life, const std::vector<core::RegionId>& regions);

  /// The link to a region; null: there is none.
  Link* find(core::RegionId region);
  /// Makes the links that are missing, if bodies need regions that were none of the first ones.
  void add(const std::vector<core::RegionId>& regions) { add(regions, false); }
  /// Removes the link to a region that was none of the first ones, with its endpoints.
  void remove(core::RegionId region);
  /// The writer of hand-offs to the link's region. Makes it if need be: then it has yet to be matched.
  Writer& migrations_to(Link& link);
  const std::vector<std::unique_ptr<Link>>& all() const { return links_; }
  /// The link to the region to which a writer belongs, by its partition, or else to `claimed` if the writer may be
  /// any region's. Null: there is none.
  Link* of_writer(const Guid& writer, core::RegionId claimed);

  /// The process that is the node of the link's region. While no status names it: the process whose writer was matched
  /// first.
  std::optional<ProcessPrefix> node_of(const Link& link) const;
  /// The aura writer of the region's node.
  RemoteWriter aura_writer_of(const Link& link) const;
  /// True if the process that was the region's node has gone or fallen silent.
  bool is_lost(const Link& link) const;
  /// Number of the region's endpoints that have to be matched.
  static std::size_t endpoints_of(const Link& link);
  /// Names of those that are not matched yet.
  std::vector<std::string> unmatched(const Link& link) const;

  Writer& auras() { return aura_writer_; }
  /// Readers of auras: one for the first regions, and one for each later one.
  const std::vector<std::unique_ptr<Reader>>& aura_readers() const { return aura_readers_; }
  Reader& migrations() { return migration_reader_; }

 private:
  void add(const std::vector<core::RegionId>& regions, bool are_first);
  void add_reader(const std::vector<core::RegionId>& regions, bool are_first);

  Domain& domain_;
  core::RegionId self_;
  core::Generation life_;
  Writer aura_writer_;
  Reader migration_reader_;
  std::vector<std::unique_ptr<Reader>> aura_readers_;
  std::vector<std::unique_ptr<Link>> links_;  ///< to the first regions, then to others as they were needed
};

}  // namespace aurasim::dds
