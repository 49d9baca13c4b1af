#include "node/seam_gathering.h"

#include <algorithm>

#include "core/keep_one_of_each.h"
#include "core/seam_tree.h"
#include "physics/parcel.h"

namespace aurasim::node {
namespace {

using core::Introduction;
using core::RegionId;

std::vector<std::uint32_t> numbers_of(std::span<const Introduction> pairs) {
  std::vector<std::uint32_t> numbers;
  for (const Introduction& pair : pairs) {
    numbers.push_back(core::value_of(pair.a));
    numbers.push_back(core::value_of(pair.b));
  }
  return numbers;
}

void append(std::vector<Introduction>& pairs, std::span<const std::byte> parcel, std::size_t regions) {
  physics::ParcelReader reader(parcel);
  const std::vector<std::uint32_t> numbers = reader.take_all<std::uint32_t>();
  const auto is_region = [regions](std::uint32_t number) { return number < regions; };
  if (!reader.at_end() || numbers.size() % 2 != 0 || !std::ranges::all_of(numbers, is_region))
    throw physics::BadParcel("a parcel names regions that are none");
  for (std::size_t i = 0; i < numbers.size(); i += 2) pairs.push_back({RegionId{numbers[i]}, RegionId{numbers[i + 1]}});
}

}  // namespace

std::vector<Introduction> gather_pairs(core::SeamMail& mail, RegionId self, std::size_t regions,
                                       std::span<const Introduction> known) {
  const core::SeamTree tree(regions);
  const std::vector<RegionId> children = tree.children(self);
  const std::optional<RegionId> parent = tree.parent(self);
  std::vector<Introduction> pairs(known.begin(), known.end());
  physics::ParcelWriter parcel;
  for (const RegionId child : children) {
    // A leaf has said all that it knows in its batch, which is here.
    if (!tree.is_leaf(child)) append(pairs, mail.fetch(child), regions);
  }
  core::keep_one_of_each(pairs);
  if (parent) {
    if (!children.empty()) {
      parcel.put_all<std::uint32_t>(numbers_of(pairs));
      mail.post(*parent, parcel.bytes());
    }
    pairs.clear();
    append(pairs, mail.fetch(*parent), regions);
    parcel.clear();
  }
  parcel.put_all<std::uint32_t>(numbers_of(pairs));
  for (const RegionId child : children) mail.post(child, parcel.bytes());
  return pairs;
}

}  // namespace aurasim::node
