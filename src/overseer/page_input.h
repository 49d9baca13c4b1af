// What pages send, read and checked. Nothing that a page sends can do more than be refused, with a text that says why.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "overseer/commands.h"
#include "overseer/eye.h"
#include "overseer/world_frame.h"

namespace aurasim::overseer {

/// Longer messages are refused before they are read. Meshes go to /api/shapes.
inline constexpr std::size_t kLongestMessage = 64 * 1024;

struct Show {
  bool auras = false;
  bool links = false;
  bool contacts = false;
};
/// What the page looks at.
struct View {
  bool hidden = false;     ///< nobody sees it
  std::optional<Eye> eye;  ///< nothing: it wants everything as it is
};
struct Watch {
  std::optional<Slot> slot;
};
struct CommandMessage {
  std::string request;
  Command command;
};
struct ReplayControl {
  enum class Action : std::uint8_t { kPlay, kPause, kSeek, kSpeed };
  Action action = Action::kPlay;
  double value = 0;  ///< step, or steps per step of the recorded time
};
using PageMessage = std::variant<Show, View, Watch, CommandMessage, ReplayControl>;

struct BadMessage {
  std::string why;
  std::string request;  ///< of a command, when that much could be read: it is answered
};

std::variant<PageMessage, BadMessage> read_page_message(std::string_view text);

}  // namespace aurasim::overseer
