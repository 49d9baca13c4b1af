// Messages that wait to be sent to one page. The memory is bounded however slow the page is: notices keep only the
// latest of each kind, frames are merged (frame_codec.h), and replies are limited.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "overseer/frame_codec.h"
#include "overseer/page_input.h"

namespace aurasim::overseer {

/// Kinds of JSON messages of which only the latest is kept, in the order in which they are sent.
enum class Notice : std::uint8_t { kHello, kScene, kMoves, kMap, kStatus, kReplay, kBody };
inline constexpr std::size_t kNotices = 7;

using SharedText = std::shared_ptr<const std::string>;
using SharedBytes = std::shared_ptr<const Bytes>;

struct Message {
  SharedText text;    ///< a text message, or null
  SharedBytes bytes;  ///< a binary message, or null
  bool is_frame = false;
};

class ClientOutbox {
 public:
  void publish(Notice notice, SharedText text);
  /// Queues a reply. Returns false if too many are waiting, because the page does not read.
  bool reply(std::string text);
  void note(const WorldFrame& frame) { frames_.note(frame); }
  /// Sets what the page looks at. A hidden page is sent only replies; the rest follows when it is visible again.
  void look(const View& view);
  void show(SharedBytes overlays) { overlays_ = std::move(overlays); }

  /// Returns the next message to send, or nothing. `frames_too`: false when the last frame was sent only a moment ago.
  std::optional<Message> next(const SlotTable& table, bool frames_too);

  bool has_frame() const { return frames_.has_news() && !hidden_; }
  std::uint64_t frames_merged() const { return frames_.merged(); }

 private:
  std::array<SharedText, kNotices> notices_;
  std::deque<std::string> replies_;
  ClientFrames frames_;
  SharedBytes overlays_;
  bool hidden_ = false;
};

}  // namespace aurasim::overseer
