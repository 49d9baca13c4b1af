// A map of bounded size, for keys that anybody on the network can create. When it is full the least recently used half
// is forgotten at once.
#pragma once

#include <cstddef>
#include <functional>
#include <unordered_map>
#include <utility>

namespace aurasim::rtps {

/// Two generations: entries used since the last rotation stay, the older half is dropped at the next one.
template <class Key, class Value, class Hash = std::hash<Key>>
class Recent {
 public:
  /// Returns the value under `key`, and creates it by `make()` if there is none. Valid until the next call.
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

}  // namespace aurasim::rtps
