#include "transport/memory_seams.h"

#include <algorithm>
#include <exception>
#include <thread>

namespace aurasim::transport {

class MemorySeams::Box final : public core::SeamMail {
 public:
  Box(MemorySeams& seams, core::RegionId self) : seams_(seams), self_(self) {}
  void post(core::RegionId to, std::span<const std::byte> parcel) override { seams_.put(self_, to, parcel); }
  std::span<const std::byte> fetch(core::RegionId from) override { return last_[from] = seams_.take(from, self_); }

 private:
  MemorySeams& seams_;
  core::RegionId self_;
  std::map<core::RegionId, std::vector<std::byte>> last_;
};

MemorySeams::MemorySeams(std::size_t regions) {
  for (std::uint32_t i = 0; i < regions; ++i) boxes_.push_back(std::make_unique<Box>(*this, core::RegionId{i}));
}

MemorySeams::~MemorySeams() = default;

core::SeamMail& MemorySeams::of(core::RegionId region) { return *boxes_.at(core::value_of(region)); }

void MemorySeams::run(std::span<const std::function<void()>> works) {
  closed_ = false;
  std::exception_ptr first;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < works.size(); ++i) {
    threads.emplace_back([this, i, &works, &first] {
      const std::lock_guard turn(mutex_);
      try {
        works[i]();
      } catch (...) {
        if (!closed_) first = std::current_exception();
        closed_ = true;  // the others would wait in vain
        arrived_.notify_all();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  ending_.reset();
  if (first) std::rethrow_exception(first);
}

void MemorySeams::put(core::RegionId from, core::RegionId to, std::span<const std::byte> parcel) {
  if (ending_ && ending_->first == from && ending_->second-- == 0) {
    throw core::SeamsBroken("the process has died in the middle of a step");
  }
  parcels_[{from, to}].emplace_back(parcel.begin(), parcel.end());
  ++posted_.count;
  posted_.bytes += parcel.size();
  arrived_.notify_all();
}

std::vector<std::byte> MemorySeams::take(core::RegionId from, core::RegionId to) {
  std::unique_lock turn(mutex_, std::adopt_lock);
  auto& waiting = parcels_[{from, to}];
  arrived_.wait(turn, [&] { return closed_ || !waiting.empty(); });
  turn.release();  // the turn is still this thread's
  if (waiting.empty()) throw core::SeamsBroken("another region has ended in the middle of a step");
  std::vector<std::byte> parcel = std::move(waiting.front());
  waiting.pop_front();
  return parcel;
}

bool MemorySeams::is_empty() const {
  return std::ranges::all_of(parcels_, [](const auto& parcels) { return parcels.second.empty(); });
}

}  // namespace aurasim::transport
