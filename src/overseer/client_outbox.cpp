#include "overseer/client_outbox.h"

#include <utility>

namespace aurasim::overseer {
namespace {

constexpr std::size_t kMostReplies = 256;

}  // namespace

void ClientOutbox::publish(Notice notice, SharedText text) {
  notices_[static_cast<std::size_t>(notice)] = std::move(text);
}

void ClientOutbox::look(const View& view) {
  hidden_ = view.hidden;
  frames_.look(view.eye);
  if (hidden_) overlays_ = nullptr;  // they would be outdated when the page is visible again
}

bool ClientOutbox::reply(std::string text) {
  if (replies_.size() >= kMostReplies) return false;
  replies_.push_back(std::move(text));
  return true;
}

std::optional<Message> ClientOutbox::next(const SlotTable& table, bool frames_too) {
  for (SharedText& notice : notices_) {
    if (notice && !hidden_) return Message{std::exchange(notice, nullptr), nullptr};
  }
  if (!replies_.empty()) {
    Message message{std::make_shared<const std::string>(std::move(replies_.front())), nullptr};
    replies_.pop_front();
    return message;
  }
  if (hidden_) return std::nullopt;
  if (frames_.has_news() && frames_too) {
    return Message{nullptr, std::make_shared<const Bytes>(frames_.encode(table)), true};
  }
  if (overlays_ && !frames_.has_news()) return Message{nullptr, std::exchange(overlays_, nullptr)};
  return std::nullopt;
}

}  // namespace aurasim::overseer
