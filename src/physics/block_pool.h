// Memory for many objects of one size. A standard pool rounds sizes up to steps of up to a third, which for contact
// manifolds would be a quarter of their memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace aurasim::physics {

/// Memory is given back to the system when the pool is destroyed. Not for several threads at once.
class BlockPool {
 public:
  static constexpr std::size_t kAlignment = 64;  ///< a cache line

  /// `bytes`: size of an object.
  explicit BlockPool(std::size_t bytes) : bytes_((bytes + kAlignment - 1) / kAlignment * kAlignment) {}
  BlockPool(const BlockPool&) = delete;
  BlockPool& operator=(const BlockPool&) = delete;

  void* take() {
    if (free_ == nullptr) grow();
    Free* const block = free_;
    free_ = block->next;
    return block;
  }
  void give_back(void* block) { free_ = new (block) Free{free_}; }

 private:
  struct Free {
    Free* next;
  };
  struct Delete {
    void operator()(std::byte* chunk) const { ::operator delete(chunk, std::align_val_t(kAlignment)); }
  };
  /// Blocks of the first chunk, and how often that number doubles.
  static constexpr std::size_t kFewest = 16, kDoublings = 4;

  /// Chunks grow with the number of objects, so that a small world takes little.
  void grow() {
    const std::size_t count = kFewest << std::min(chunks_.size(), kDoublings);
    auto* const chunk = static_cast<std::byte*>(::operator new(count* bytes_, std::align_val_t(kAlignment)));
    chunks_.emplace_back(chunk);
    for (std::size_t i = count; i > 0; --i) give_back(chunk + (i - 1) * bytes_);
  }

  std::size_t bytes_;
  Free* free_ = nullptr;
  std::vector<std::unique_ptr<std::byte, Delete>> chunks_;
};

}  // namespace aurasim::physics
