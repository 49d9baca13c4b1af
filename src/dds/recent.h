// A map of bounded size, of what anybody can fill: the least recently seen are forgotten first, half of them at once.
#pragma once

#include <cstddef>
#include <functional>
#include <unordered_map>
#include <utility>

namespace aurasim::dds {

/// Keeps those that were seen since the last time that half of them had come.
template <class Key, class Value, class Hash = std::hash<Key>>
class Recent {
 public:
  /// What is kept under `key`, or else what `make` makes. Valid until the next call.
  template <class Make>
  Value& find(const Key& key, std::size_t most, Make make) {
    if (const auto it = young_.find(key); it != young_.end()) return it->second;
    if (young_.size() >= most / 2) {
      old_ = std::move(young_);
      young_.clear();
    }
    if (const auto it = old_.find(key); it != old_.end()) {
      Value value = it->second;
      old_.erase(it);
      return young_.emplace(key, std::move(value)).first->second;
    }
    return young_.emplace(key, make()).first->second;
  }

 private:
  std::unordered_map<Key, Value, Hash> young_, old_;
};

}  // namespace aurasim::dds
