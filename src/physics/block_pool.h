// Memory for many objects of one size. A standard pool rounds sizes up to steps of up to a third, which for contact
// manifolds would be a quarter of their memory, and gives nothing back before its end.
#pragma once

#include <cstddef>
#include <new>

#include <sys/mman.h>

namespace aurasim::physics {

/// Memory comes in chunks. A chunk of which nothing is used is given back to the system at once, except one. Not for
/// several threads at once.
class BlockPool {
 public:
  static constexpr std::size_t kAlignment = 16;

  /// `bytes`: size of an object, at most a chunk without its head.
  explicit BlockPool(std::size_t bytes) : bytes_(sizeof(Block) + rounded(bytes)) {}
  /// All objects have to be given back before.
  ~BlockPool() {
    while (open_ != nullptr) close(*open_);
  }
  BlockPool(const BlockPool&) = delete;
  BlockPool& operator=(const BlockPool&) = delete;

  /// The largest size of an object, bytes.
  std::size_t bytes() const { return bytes_ - sizeof(Block); }

  void* take() {
    if (open_ == nullptr) grow();
    Chunk& chunk = *open_;
    Block* block = chunk.free;
    if (block != nullptr) {
      chunk.free = block->next;
    } else {
      block = new (reinterpret_cast<std::byte*>(&chunk) + kHead + bytes_ * chunk.touched++) Block;
    }
    if (chunk.used++ == 0) --empty_;
    block->chunk = &chunk;
    if (chunk.free == nullptr && chunk.touched == room()) unlink(chunk);
    return block + 1;
  }

  void give_back(void* object) {
    Block* const block = static_cast<Block*>(object) - 1;
    Chunk& chunk = *block->chunk;
    if (chunk.free == nullptr && chunk.touched == room()) link(chunk);
    block->next = chunk.free;
    chunk.free = block;
    if (--chunk.used > 0) return;
    if (++empty_ > 1) close(chunk);
  }

 private:
  struct Chunk;
  /// Lies before an object.
  struct alignas(kAlignment) Block {
    Chunk* chunk = nullptr;
    Block* next = nullptr;  ///< if it is free
  };
  struct Chunk {
    Chunk *next = nullptr, *before = nullptr;  ///< in the list of those with a free block
    Block* free = nullptr;
    std::size_t used = 0, touched = 0;  ///< numbers of blocks: in use, and ever in use
  };
  static constexpr std::size_t kChunk = std::size_t{1} << 17U;
  static constexpr std::size_t rounded(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }
  static constexpr std::size_t kHead = (sizeof(void*) * 5 + kAlignment - 1) / kAlignment * kAlignment;

  std::size_t room() const { return (kChunk - kHead) / bytes_; }

  void grow() {
    void* const memory = mmap(nullptr, kChunk, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    static_assert(sizeof(Chunk) <= kHead);
    link(*new (memory) Chunk);
    ++empty_;
  }
  void close(Chunk& chunk) {
    unlink(chunk);
    --empty_;
    munmap(&chunk, kChunk);
  }
  void link(Chunk& chunk) {
    chunk.before = nullptr, chunk.next = open_;
    if (open_ != nullptr) open_->before = &chunk;
    open_ = &chunk;
  }
  void unlink(Chunk& chunk) {
    (chunk.before == nullptr ? open_ : chunk.before->next) = chunk.next;
    if (chunk.next != nullptr) chunk.next->before = chunk.before;
  }

  std::size_t bytes_;      ///< of a block and its object
  Chunk* open_ = nullptr;  ///< the first chunk with a free block
  std::size_t empty_ = 0;  ///< chunks of which nothing is used
};

}  // namespace aurasim::physics
