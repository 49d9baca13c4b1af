#include "config/packed_nodes.h"

namespace aurasim::config {
namespace {

// The first byte of a node: its kind, and
constexpr unsigned kKindBits = 0x03, kQuoted = 0x04, kHasKey = 0x08;

/// Seven bits a byte, the lowest first; all bytes but the last have the highest bit set.
void put_number(std::uint64_t value, std::string& to) {
  for (; value >= 0x80; value >>= 7) to += static_cast<char>(0x80 | (value & 0x7f));
  to += static_cast<char>(value);
}

void put_text(std::string_view text, std::string& to) {
  put_number(text.size(), to);
  to += text;
}

/// Small numbers of either sign become small numbers.
std::uint64_t folded(std::int64_t value) {
  return value < 0 ? ~(static_cast<std::uint64_t>(value) << 1) : static_cast<std::uint64_t>(value) << 1;
}
std::int64_t unfolded(std::uint64_t value) { return static_cast<std::int64_t>(value & 1 ? ~(value >> 1) : value >> 1); }

/// A line is written as the difference to the one before.
void put_place(const Place& place, int& line, std::string& to) {
  put_number(folded(std::int64_t{place.line} - line), to);
  put_number(folded(place.column), to);
  line = place.line;
}

}  // namespace

std::uint64_t PackedNodes::Cursor::number() {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const auto byte = static_cast<unsigned char>(rest.front());
    rest.remove_prefix(1);
    value |= std::uint64_t{byte & 0x7fU} << shift;
    if (byte < 0x80) return value;
  }
}

std::string_view PackedNodes::Cursor::text(std::size_t length) {
  const std::string_view text = rest.substr(0, length);
  rest.remove_prefix(length);
  return text;
}

std::uint64_t PackedNodes::number_of(const std::string& key) {
  const auto [place, is_new] = key_numbers_.try_emplace(key, keys_.size());
  if (is_new) keys_.push_back(key);
  return place->second;
}

void PackedNodes::add(const YamlNode& entry) {
  if (size_ % kOfChunk == 0) {
    if (!chunks_.empty()) chunks_.back().shrink_to_fit();
    chunks_.emplace_back();
    last_line_ = 0;
  }
  put(entry, last_line_);
  ++size_;
}

void PackedNodes::put(const YamlNode& node, int& line) {
  ++count_;
  std::string& to = chunks_.back();
  const bool has_key = !node.key.empty() || node.key_place.line != 0;
  to += static_cast<char>(static_cast<unsigned>(node.kind) | (node.quoted ? kQuoted : 0) | (has_key ? kHasKey : 0));
  if (has_key) {
    put_number(number_of(node.key), to);
    put_place(node.key_place, line, to);
  }
  put_place(node.place, line, to);
  if (node.kind == YamlNode::Kind::kText) put_text(node.text, to);
  if (node.kind != YamlNode::Kind::kList && node.kind != YamlNode::Kind::kMap) return;
  put_number(node.children.size(), to);
  for (const YamlNode& child : node.children) put(child, line);
}

YamlNode PackedNodes::get(Cursor& from, int& line) const {
  const auto place = [&] {
    line += static_cast<int>(unfolded(from.number()));
    return Place{source_, line, static_cast<int>(unfolded(from.number()))};
  };
  const auto head = static_cast<unsigned>(from.number());
  YamlNode node;
  node.kind = static_cast<YamlNode::Kind>(head & kKindBits);
  node.quoted = (head & kQuoted) != 0;
  if ((head & kHasKey) != 0) {
    node.key = keys_[from.number()];
    node.key_place = place();
  }
  node.place = place();
  if (node.kind == YamlNode::Kind::kText) node.text = from.text(from.number());
  if (node.kind != YamlNode::Kind::kList && node.kind != YamlNode::Kind::kMap) return node;
  const std::uint64_t count = from.number();
  node.children.reserve(count);
  for (std::uint64_t i = 0; i < count; ++i) node.children.push_back(get(from, line));
  return node;
}

YamlNode& PackedNodes::unpacked(std::size_t index) {
  const auto known = unpacked_.find(index);
  if (known != unpacked_.end()) return known->second;
  Cursor cursor{chunks_[index / kOfChunk]};
  int line = 0;
  for (std::size_t i = 0; i < index % kOfChunk; ++i) get(cursor, line);
  return unpacked_.emplace(index, get(cursor, line)).first->second;
}

}  // namespace aurasim::config
