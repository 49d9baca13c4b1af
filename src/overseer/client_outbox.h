// What waits to be sent to one page. However slow the page, this does not grow: of everything that can be sent anew
// only the latest is kept, frames are merged (frame_codec.h), and replies are limited.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "overseer/frame_codec.h"
#include "overseer/page_input.h"

namespace aurasim::overseer {

/// JSON of which only the latest counts, in the order in which they are sent.
enum class Notice : std::uint8_t { kHello, kScene, kMoves, kMap, kStatus, kReplay, kBody };
inline constexpr std::size_t kNotices = 7;

using SharedText = std::shared_ptr<const std::string>;
using SharedBytes = std::shared_ptr<const Bytes>;

struct Message {
  SharedText text;    ///< or
  SharedBytes bytes;  ///< a binary message
  bool is_frame = false;
};

class ClientOutbox {
 public:
  void publish(Notice notice, SharedText text);
  /// False: there are too many already; the page does not read.
  bool reply(std::string text);
  void note(const WorldFrame& frame) { frames_.note(frame); }
  /// A page that nobody looks at is sent nothing but replies; what it missed comes when it is looked at again.
  void look(const View& view);
  void show(SharedBytes overlays) { overlays_ = std::move(overlays); }

  /// What to send next, or nothing. `frames_too`: false when the last frame was sent only a moment ago.
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
