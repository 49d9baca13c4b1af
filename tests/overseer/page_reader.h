// The binary messages of docs/viewer.md as a page reads them, with every count checked.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <stdexcept>
#include <vector>

#include "overseer/frame_codec.h"

namespace aurasim::overseer::testing {

class BytesIn {
 public:
  explicit BytesIn(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class Number>
  Number get() {
    if (at_ + sizeof(Number) > bytes_.size()) throw std::out_of_range("the message is too short");
    Number value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

struct PageBody {
  std::uint64_t id = 0;
  std::uint32_t prototype = 0;
  std::uint16_t host = 0;
  std::uint16_t flags = 0;
  std::uint32_t epoch = 0;
  core::Vec3 p = core::Vec3::Zero();
  std::uint32_t packed = 0;
  Eigen::Quaternionf q;
};

/// What a page makes of frames. Throws std::logic_error when one breaks a rule of docs/viewer.md.
class PageWorld {
 public:
  void read(std::span<const std::uint8_t> bytes) {
    BytesIn in(bytes);
    expect(in.get<std::uint8_t>() == 1, "type");
    const auto flags = in.get<std::uint8_t>();
    expect(in.get<std::uint16_t>() == 2, "version");
    generation = in.get<std::uint32_t>();
    stamp = in.get<double>();
    std::array<std::uint32_t, 4> counts{};
    for (std::uint32_t& count : counts) count = in.get<std::uint32_t>();
    if ((flags & 1) != 0) bodies.clear();
    ++frames;
    key_frames += flags & 1;
    for (std::uint32_t i = 0; i < counts[0]; ++i) expect(bodies.erase(in.get<std::uint32_t>()) == 1, "deleted unknown");
    read_created(in, counts[1]);
    for (std::uint32_t i = 0; i < counts[2]; ++i) {
      PageBody& body = known(in.get<std::uint32_t>());
      body.host = in.get<std::uint16_t>();
      body.flags = in.get<std::uint16_t>();
      body.epoch = in.get<std::uint32_t>();
    }
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < counts[3]; ++i) {
      const auto head = in.get<std::uint8_t>();
      const std::uint32_t slot = head >> 4 == 15 ? in.get<std::uint32_t>() : next + (head >> 4);
      next = slot + 1;
      ++poses;
      read_pose(in, head, known(slot));
    }
    expect(in.at_end(), "more bytes than counted");
  }

  /// By id; throws when two slots have the same body.
  std::map<std::uint64_t, PageBody> by_id() const {
    std::map<std::uint64_t, PageBody> result;
    for (const auto& [slot, body] : bodies) expect(result.emplace(body.id, body).second, "a body twice");
    return result;
  }

  std::map<std::uint32_t, PageBody> bodies;
  std::uint32_t generation = 0;
  double stamp = -1;
  int frames = 0;
  int key_frames = 0;
  int poses = 0;  ///< rows, so far

 private:
  static void expect(bool holds, const char* what) {
    if (!holds) throw std::logic_error(what);
  }
  void read_created(BytesIn& in, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto slot = in.get<std::uint32_t>();
      PageBody body;
      body.prototype = in.get<std::uint32_t>();
      const std::uint64_t low = in.get<std::uint32_t>();
      body.id = low | std::uint64_t{in.get<std::uint32_t>()} << 32U;
      expect(bodies.emplace(slot, body).second, "created twice");
    }
  }
  static void read_pose(BytesIn& in, std::uint8_t head, PageBody& body) {
    for (int k = 0; k < 3; ++k) {
      const int how = head & 3;
      if (how == 1) body.p[k] += in.get<std::int8_t>() / 2048.0;
      if (how == 2) body.p[k] += in.get<std::int16_t>() / 2048.0;
      if (how != 3) continue;
      const double low = in.get<std::uint32_t>();
      body.p[k] = (low + 4294967296.0 * in.get<std::int16_t>()) / 2048;
    }
    const int turn = (head >> 2) & 3;
    expect(turn < 3, "way of a rotation");
    if (turn == 2) body.packed = in.get<std::uint32_t>();
    for (int k = 0, shift = 20; k < 3 && turn == 1; ++k, shift -= 10) {
      const std::uint32_t level = (body.packed >> shift & 1023U) + static_cast<std::uint32_t>(in.get<std::int8_t>());
      body.packed = (body.packed & ~(1023U << shift)) | (level & 1023U) << shift;
    }
    body.q = unpack_rotation(body.packed);
  }
  PageBody& known(std::uint32_t slot) {
    const auto found = bodies.find(slot);
    expect(found != bodies.end(), "unknown slot");
    return found->second;
  }
};

}  // namespace aurasim::overseer::testing
