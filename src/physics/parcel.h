// The bytes of a parcel between coupled regions: numbers one after the other, little-endian, without gaps.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "core/seam_mail.h"

namespace aurasim::physics {

static_assert(std::endian::native == std::endian::little);

/// Thrown for a parcel that is too short or holds what no region sends.
class BadParcel : public core::SeamsBroken {
 public:
  using core::SeamsBroken::SeamsBroken;
};

class ParcelWriter {
 public:
  void clear() { bytes_.clear(); }
  std::span<const std::byte> bytes() const { return bytes_; }

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { append(&value, sizeof(T)); }
  /// The number of items, then each of them.
  template <class T>
  requires std::is_arithmetic_v<T>
  void put_all(std::span<const T> values) {
    put(static_cast<std::uint32_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void put_some(const T* values, std::size_t count) { append(values, count * sizeof(T)); }

 private:
  void append(const void* from, std::size_t size) {
    const auto* const first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  std::vector<std::byte> bytes_;
};

class ParcelReader {
 public:
  explicit ParcelReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool at_end() const { return bytes_.empty(); }

  template <class T>
  requires std::is_arithmetic_v<T> T take() {
    T value;
    take_some(&value, 1);
    return value;
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void take_some(T* values, std::size_t count) {
    if (count > bytes_.size() / sizeof(T)) throw BadParcel("a parcel between regions is too short");
    if (count == 0) return;
    std::memcpy(values, bytes_.data(), count * sizeof(T));
    bytes_ = bytes_.subspan(count * sizeof(T));
  }
  /// A number of items of at least `least_size` bytes each.
  std::uint32_t take_count(std::size_t least_size) {
    const auto count = take<std::uint32_t>();
    if (count > bytes_.size() / least_size) throw BadParcel("a parcel between regions is too short");
    return count;
  }
  template <class T>
  requires std::is_arithmetic_v<T> std::vector<T> take_all() {
    std::vector<T> values(take_count(sizeof(T)));
    take_some(values.data(), values.size());
    return values;
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace aurasim::physics
