// Parses and checks the messages of pages. An invalid message has no effect but a refusal with the reason.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "overseer/commands.h"
#include "overseer/eye.h"
#include "overseer/world_frame.h"

namespace aurasim::overseer {

/// Longest message, bytes. Longer ones are refused before they are read. Meshes go to /api/shapes instead.
inline constexpr std::size_t kLongestMessage = 64 * 1024;

struct Show {
  bool auras = false;
  bool links = false;
  bool contacts = false;
};
/// The page's view of the world.
struct View {
  bool hidden = false;     ///< the page is hidden
  std::optional<Eye> eye;  ///< viewpoint; nothing: the page wants everything exactly
};
struct Watch {
  std::optional<Slot> slot;
};
struct CommandMessage {
  std::string request;
  steering::Ask ask;
};
struct ReplayControl {
  enum class Action : std::uint8_t { kPlay, kPause, kSeek, kSpeed };
  Action action = Action::kPlay;
  double value = 0;  ///< kSeek: a step; kSpeed: steps shown per step of the recorded time
};
using PageMessage = std::variant<Show, View, Watch, CommandMessage, ReplayControl>;

struct BadMessage {
  std::string why;
  std::string request;  ///< id of the command, if that could be parsed: then the refusal is a reply to it
};

std::variant<PageMessage, BadMessage> read_page_message(std::string_view text);

}  // namespace aurasim::overseer
