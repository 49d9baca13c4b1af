#include "overseer/web_hub.h"

#include <utility>

#include <fmt/format.h>

#include "overseer/http_rules.h"
#include "overseer/page_messages.h"

namespace aurasim::overseer {
namespace {

constexpr std::size_t kMostRequests = 1000;
constexpr const char* kTokenIsNeeded = "this takes a token: the one for operators";

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

std::string reply_text(const Reply& reply) {
  nlohmann::json json = {{"type", "reply"}, {"request", reply.request}, {"ok", reply.ok}, {"text", reply.text}};
  if (!reply.result.is_null()) json["result"] = reply.result;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void WebHub::join(const std::shared_ptr<PageConnection>& page) {
  page->id = ClientId{next_id_++};
  pages_.emplace(page->id, page);
  clients_ = pages_.size();
  for (std::size_t i = 0; i < kNotices; ++i) {
    if (notices_[i]) page->outbox.publish(static_cast<Notice>(i), notices_[i]);
  }
  page->outbox.note(
      {.generation = table_.generation(), .stamp = table_.stamp(), .restart = true, .deleted = {}, .changed = {}});
  page->pump();
}

void WebHub::leave(ClientId id) {
  const auto found = pages_.find(id);
  if (found == pages_.end()) return;
  frames_skipped_ += found->second->outbox.frames_merged();
  pages_.erase(found);
  clients_ = pages_.size();
  note_wanted();
}

void WebHub::note_wanted() {
  Show wanted;
  for (const auto& [id, page] : pages_) {
    wanted.auras |= page->show.auras;
    wanted.links |= page->show.links;
    wanted.contacts |= page->show.contacts;
  }
  auras_wanted_ = wanted.auras;
  links_wanted_ = wanted.links;
  contacts_wanted_ = wanted.contacts;
}

void WebHub::read(PageConnection& page, std::string_view text) {
  auto read = read_page_message(text);
  if (const auto* bad = std::get_if<BadMessage>(&read)) {
    ++refused_;
    reply(page, {page.id, bad->request, false, bad->why, nullptr});
  } else {
    handle(page, std::get<PageMessage>(read));
  }
}

void WebHub::handle(PageConnection& page, PageMessage& message) {
  std::visit(Overloaded{[&](const Show& show) {
                          page.show = show;
                          note_wanted();
                        },
                        [&](const View& view) {
                          page.outbox.look(view);
                          page.pump();
                        },
                        [&](const Watch& wanted) { watch(page, wanted); },
                        [&](CommandMessage& command) { take_command(page, command); },
                        [&](const ReplayControl& control) {
                          if (page.standing < Standing::kOperator || !enqueue(control)) ++refused_;
                        }},
             message);
}

void WebHub::take_command(PageConnection& page, CommandMessage& message) {
  const auto refuse = [&](const char* why) {
    ++refused_;
    reply(page, {page.id, message.request, false, why, nullptr});
  };
  const bool is_ray = !steering::changes_the_world(message.ask);
  if (!is_ray && page.standing < Standing::kOperator) {
    refuse(kTokenIsNeeded);
  } else if (is_ray && !may_cast_a_ray(page)) {
    refuse("too many rays: try again in a moment");
  } else if (!enqueue(Request{page.id, message.request, std::move(message.ask)})) {
    refuse("too many commands at once");
  }
}

bool WebHub::may_cast_a_ray(PageConnection& page) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return !page.rays.is_spent(now) && rays_.take(1, now) && page.rays.take(1, now);
}

bool WebHub::enqueue(PageRequest request) {
  const std::lock_guard lock(requests_mutex_);
  if (requests_.size() >= kMostRequests) return false;
  requests_.push_back(std::move(request));
  return true;
}

void WebHub::enter(const std::shared_ptr<WebCaller>& caller) {
  ++connections_;
  if (callers_.enter(caller)) ++refused_;
}

std::vector<PageRequest> WebHub::take_requests() {
  const std::lock_guard lock(requests_mutex_);
  return std::exchange(requests_, {});
}

void WebHub::reply(PageConnection& page, const Reply& reply) {
  if (page.outbox.reply(reply_text(reply))) {
    page.pump();
  } else {
    page.drop_if_stalled(std::chrono::steady_clock::duration(-1));
  }
}

void WebHub::answer(const Reply& answered) {
  const auto found = pages_.find(answered.client);
  if (found != pages_.end()) reply(*found->second, answered);
}

void WebHub::watch(PageConnection& page, const Watch& watch) {
  page.watched.reset();
  const ViewBody* body = watch.slot ? table_.body(*watch.slot) : nullptr;
  if (body != nullptr) page.watched = body->id;
  publish_watched(page);
  page.pump();
}

void WebHub::publish_watched(PageConnection& page) {
  if (!page.watched) return;
  for (Slot slot = 0; slot < table_.slot_count(); ++slot) {
    const ViewBody* body = table_.body(slot);
    if (body == nullptr || body->id != *page.watched) continue;
    page.outbox.publish(Notice::kBody, std::make_shared<const std::string>(body_message(*body)));
    return;
  }
  page.outbox.publish(Notice::kBody, std::make_shared<const std::string>(body_gone_message(*page.watched)));
  page.watched.reset();
}

void WebHub::publish(Notice notice, SharedText text) {
  notices_[static_cast<std::size_t>(notice)] = text;
  for (const auto& [id, page] : std::map(pages_)) {
    page->outbox.publish(notice, text);
    if (notice == Notice::kStatus) publish_watched(*page);
    page->pump();
  }
}

void WebHub::show(const WorldFrame& frame) {
  table_.apply(frame);
  for (const auto& [id, page] : std::map(pages_)) {
    page->outbox.note(frame);
    page->pump();
  }
}

void WebHub::show_overlays(const SharedBytes& overlays) {
  for (const auto& [id, page] : std::map(pages_)) {
    if (!page->show.auras && !page->show.links && !page->show.contacts) continue;
    page->outbox.show(overlays);
    page->pump();
  }
}

void WebHub::drop_stalled() {
  for (const auto& [id, page] : std::map(pages_)) {
    if (page->drop_if_stalled(settings_.stall_limit)) ++dropped_;
  }
}

void WebHub::count_sent(const Message& message, std::size_t bytes) {
  bytes_sent_ += bytes;
  frames_sent_ += message.is_frame;
}

WebCounters WebHub::counters() const {
  return {clients_,    connections_, frames_sent_, frames_skipped_,
          bytes_sent_, refused_,     dropped_,     access_.wrong_tokens()};
}

PagePlace WebHub::page_place(const std::string& address) {
  std::erase_if(page_places_of_, [](const auto& entry) { return entry.second == 0; });
  const std::size_t most = is_loopback_address(address) ? settings_.most_clients : settings_.most_clients_of_one;
  return {{page_places_, settings_.most_clients}, {page_places_of_[address], most}};
}

HttpAnswer WebHub::session(Standing standing) {
  const char* const may = standing == Standing::kOperator ? "operate"
                          : standing == Standing::kViewer ? "look"
                                                          : "nothing";
  return {.content_type = "application/json", .body = nlohmann::json{{"may", may}}.dump() + "\n"};
}

HttpAnswer WebHub::get(std::string_view target, const FileRequest& request, Standing standing) {
  const std::string_view path = path_of(target);
  if (path == "/healthz") return {.body = "ok\n"};
  if (path == "/api/session") return session(standing);
  const bool is_about_the_run = path == "/metrics" || path.starts_with("/api/");
  if (is_about_the_run && standing < Standing::kViewer) {
    ++refused_;
    return {.status = 401, .body = "this takes a token\n"};
  }
  if (path == "/metrics") return {.content_type = "text/plain; version=0.0.4; charset=utf-8", .body = metrics()};
  if (path == "/api/scenes")
    return {.content_type = "application/json", .body = nlohmann::json{{"scenes", settings_.scenes}}.dump() + "\n"};
  return get_file(target, request);
}

HttpAnswer WebHub::get_file(std::string_view target, const FileRequest& request) {
  if (const auto file = files_.get(target, request)) {
    HttpAnswer answer{.content_type = file->content_type, .etag = file->etag};
    if (!file->bytes) {
      answer.status = 304;
    } else {
      answer.body = *file->bytes;
      if (file->is_gzip) answer.encoding = "gzip";
    }
    return answer;
  }
  if (path_of(target) == "/")
    return {.content_type = "text/html; charset=utf-8", .body = page_is_not_built(settings_.pages)};
  return {.status = 404, .body = "no such page\n"};
}

std::string WebHub::metrics() const {
  std::uint64_t skipped = frames_skipped_;
  for (const auto& [id, page] : pages_) skipped += page->outbox.frames_merged();
  std::string text = metrics_;
  const auto add = [&](const char* name, const char* type, const char* help, std::uint64_t value) {
    text += fmt::format("# HELP aurasim_web_{0} {1}\n# TYPE aurasim_web_{0} {2}\naurasim_web_{0} {3}\n", name, help,
                        type, value);
  };
  add("clients", "gauge", "Pages connected now.", clients_);
  add("connections_total", "counter", "TCP connections accepted.", connections_);
  add("frames_sent_total", "counter", "Frames sent to pages.", frames_sent_);
  add("frames_skipped_total", "counter", "Frames merged into later ones for slow pages.", skipped);
  add("bytes_sent_total", "counter", "Bytes of WebSocket messages sent.", bytes_sent_);
  add("refused_total", "counter", "Requests and messages refused.", refused_);
  add("wrong_tokens_total", "counter", "Requests that showed a wrong token.", access_.wrong_tokens());
  add("dropped_total", "counter", "Pages dropped because they took nothing.", dropped_);
  return text;
}

}  // namespace aurasim::overseer
