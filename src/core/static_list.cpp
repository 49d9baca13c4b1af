#include "core/static_list.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cstring>

namespace aurasim::core {
namespace {

constexpr std::string_view kUsualName = "static ";
/// A static is compared with so many kinds of its block. Scenes list what is alike one after the other.
constexpr std::size_t kCompared = 8;

/// True if the two have the same bits: -0 is not 0 here.
bool same_bits(const Quat& a, const Quat& b) {
  return std::memcmp(a.coeffs().data(), b.coeffs().data(), 4 * sizeof(double)) == 0;
}

/// The entry of a list that is ascending by `of`; null if it has none for this record.
template <class Entry>
const Entry* entry_of(const std::vector<Entry>& entries, std::size_t record) {
  const auto place = std::ranges::lower_bound(entries, record, {}, &Entry::of);
  return place != entries.end() && place->of == record ? &*place : nullptr;
}

}  // namespace

StaticList::StaticList(std::initializer_list<StaticBody> statics) {
  for (const StaticBody& body : statics) push_back(body);
}

std::pair<const StaticList::Block&, std::size_t> StaticList::place_of(std::size_t index) const {
  assert(index < size());
  const std::size_t block = index / kOfBlock;
  return {block < full_.size() ? *full_[block] : last_, index % kOfBlock};
}

StaticBody StaticList::at(std::size_t index) const {
  const auto [block, record] = place_of(index);
  const Kind& kind = block.kinds[block.records[record].kind];
  StaticBody body;
  body.shape = kind.shape;
  body.material = kind.material;
  body.pose = {block.records[record].p_WB, kind.q_WB};
  if (const Name* name = entry_of(block.named, record)) {
    const std::size_t begin = name == block.named.data() ? 0 : (name - 1)->end;
    body.name = block.names.substr(begin, name->end - begin);
  } else {
    body.name = usual_name(index);
  }
  if (const Motion* motion = entry_of(block.moving, record)) {
    body.path = motion->path;
    body.belt_S = motion->belt_S;
  }
  return body;
}

std::uint32_t StaticList::shape(std::size_t index) const {
  const auto [block, record] = place_of(index);
  return block.kinds[block.records[record].kind].shape;
}

Pose StaticList::pose(std::size_t index) const {
  const auto [block, record] = place_of(index);
  return {block.records[record].p_WB, block.kinds[block.records[record].kind].q_WB};
}

bool StaticList::moves(std::size_t index) const {
  const auto [block, record] = place_of(index);
  const Motion* motion = entry_of(block.moving, record);
  return motion != nullptr && (motion->path || !motion->belt_S.isZero());
}

std::string StaticList::usual_name(std::size_t index) { return std::string(kUsualName) + std::to_string(index); }

std::optional<std::size_t> StaticList::find_usual(std::string_view name) const {
  if (!name.starts_with(kUsualName)) return std::nullopt;
  std::size_t index = 0;
  const std::string_view number = name.substr(kUsualName.size());
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  if (error != std::errc() || index >= size() || usual_name(index) != name) return std::nullopt;
  const auto [block, record] = place_of(index);
  return entry_of(block.named, record) == nullptr ? std::optional(index) : std::nullopt;
}

std::optional<std::size_t> StaticList::find(std::string_view name) const {
  const std::size_t usual = find_usual(name).value_or(size());
  for (std::size_t first = 0; first < usual; first += kOfBlock) {
    const Block& block = place_of(first).first;
    std::size_t begin = 0;
    for (const Name& given : block.named) {
      if (first + given.of > usual) break;
      if (std::string_view(block.names).substr(begin, given.end - begin) == name) return first + given.of;
      begin = given.end;
    }
  }
  return usual < size() ? std::optional(usual) : std::nullopt;
}

std::uint16_t StaticList::kind_of(const StaticBody& body, Block& block) {
  const std::size_t count = block.kinds.size();
  for (std::size_t i = count; i > count - std::min(count, kCompared); --i) {
    const Kind& known = block.kinds[i - 1];
    const bool is_it = known.shape == body.shape && known.material == body.material;
    if (is_it && same_bits(known.q_WB, body.pose.q_WB)) return static_cast<std::uint16_t>(i - 1);
  }
  block.kinds.push_back({body.shape, body.material, body.pose.q_WB});
  return static_cast<std::uint16_t>(count);
}

void StaticList::push_back(const StaticBody& body) {
  const auto record = static_cast<std::uint16_t>(last_.records.size());
  if (body.name != usual_name(size())) {
    last_.names += body.name;
    last_.named.push_back({record, static_cast<std::uint32_t>(last_.names.size())});
  }
  if (body.path || body.belt_S != Vec3::Zero()) {
    last_.moving.push_back({record, body.path, body.belt_S});
  }
  last_.records.push_back({body.pose.p_WB, kind_of(body, last_)});
  if (last_.records.size() < kOfBlock) return;
  last_.records.shrink_to_fit();
  last_.kinds.shrink_to_fit();
  last_.named.shrink_to_fit();
  last_.names.shrink_to_fit();
  last_.moving.shrink_to_fit();
  full_.push_back(std::make_shared<const Block>(std::exchange(last_, {})));
}

void StaticList::set(std::size_t index, const StaticBody& body) {
  StaticList changed;
  changed.full_.assign(full_.begin(), full_.begin() + static_cast<std::ptrdiff_t>(index / kOfBlock));
  for (std::size_t i = changed.size(); i < size(); ++i) changed.push_back(i == index ? body : at(i));
  *this = std::move(changed);
}

}  // namespace aurasim::core
