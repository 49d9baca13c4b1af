#include "overseer/replay.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace aurasim::overseer {
namespace {

bool is_frame(const Chunk& chunk) { return chunk.kind == ChunkKind::kFrame || chunk.kind == ChunkKind::kKeyFrame; }

std::optional<Notice> notice_of(ChunkKind kind) {
  switch (kind) {
    case ChunkKind::kScene:
      return Notice::kScene;
    case ChunkKind::kMoves:
      return Notice::kMoves;
    case ChunkKind::kMap:
      return Notice::kMap;
    case ChunkKind::kStatus:
      return Notice::kStatus;
    case ChunkKind::kAbout:
    case ChunkKind::kFrame:
    case ChunkKind::kKeyFrame:
      return std::nullopt;
  }
  return std::nullopt;
}

RecordedRun read_run(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  RecordedRun run;
  try {
    run.scene = json.at("scene").get<std::string>();
    run.step_s = json.at("step_s").get<double>();
    run.tick_hz = json.at("tick_hz").get<double>();
  } catch (const nlohmann::json::exception&) {
    throw BadRecording("the recording does not say what it is of");
  }
  if (!(run.step_s > 0) || !(run.tick_hz > 0)) throw BadRecording("the recording has no sound step");
  return run;
}

/// Turns a key frame amid the others into the changes that it makes.
void make_difference(WorldFrame& key_frame, const SlotTable& before) {
  key_frame.restart = false;
  std::vector<bool> present(before.slot_count(), false);
  for (BodyChange& change : key_frame.changed) {
    const ViewBody* known = before.body(change.body.slot);
    if (known == nullptr) continue;
    present[change.body.slot] = known->id == change.body.id;
    change.created = known->id != change.body.id;
  }
  for (Slot slot = 0; slot < present.size(); ++slot) {
    if (!present[slot] && before.body(slot) != nullptr) key_frame.deleted.push_back(slot);
  }
}

}  // namespace

std::string recorded_run_text(const RecordedRun& run) {
  return nlohmann::json{{"scene", run.scene}, {"step_s", run.step_s}, {"tick_hz", run.tick_hz}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Replay::Replay(const std::filesystem::path& file) : reader_(file) {
  const auto& chunks = reader_.chunks();
  const auto about =
      std::find_if(chunks.begin(), chunks.end(), [](const Chunk& c) { return c.kind == ChunkKind::kAbout; });
  if (about == chunks.end()) throw BadRecording("the recording does not say what it is of");
  run_ = read_run(reader_.read(*about));
  lay_out();
  position_ = static_cast<double>(first_);
}

/// Gives each chunk a place; a text gets that of the frame before it. Where the run was reset its steps go back, but
/// places go on.
void Replay::lay_out() {
  const Chunk* before = nullptr;
  first_ = std::ranges::find_if(reader_.chunks(), is_frame)->step;
  core::Step place = first_;
  for (const Chunk& chunk : reader_.chunks()) {
    if (is_frame(chunk)) {
      const bool anew = before != nullptr && (chunk.generation != before->generation || chunk.step < before->step);
      if (before != nullptr) place += anew ? 1 : chunk.step - before->step;
      if (anew) resets_.push_back(place);
      before = &chunk;
    }
    places_.push_back(place);
  }
}

void Replay::apply(const ReplayControl& control) {
  using Action = ReplayControl::Action;
  switch (control.action) {
    case Action::kPlay:
      if (next_ >= reader_.chunks().size()) seek(first_);
      playing_ = true;
      break;
    case Action::kPause:
      playing_ = false;
      break;
    case Action::kSpeed:
      speed_ = control.value;
      break;
    case Action::kSeek:
      seek(
          static_cast<core::Step>(std::clamp(control.value, static_cast<double>(first_), static_cast<double>(last()))));
      break;
  }
}

/// Goes to the last key frame up to `at`; advance() plays the rest.
void Replay::seek(core::Step at) {
  const auto& chunks = reader_.chunks();
  next_ = 0;
  for (std::size_t i = 0; i < chunks.size() && places_[i] <= at; ++i) {
    if (chunks[i].kind == ChunkKind::kKeyFrame) next_ = i;
  }
  position_ = static_cast<double>(at);
  jumped_ = true;
}

/// After a jump, sends the scene, map and status of the new place if they differ from those sent last.
void Replay::tell_what_holds(Output& out) {
  std::map<Notice, std::size_t> holding;
  for (std::size_t i = 0; i < places_.size() && static_cast<double>(places_[i]) <= position_; ++i) {
    if (const auto notice = notice_of(reader_.chunks()[i].kind)) holding[*notice] = i;
  }
  for (const auto& [notice, chunk] : holding) tell(notice, chunk, out);
}

void Replay::tell(Notice notice, std::size_t chunk, Output& out) {
  const auto told = told_.find(notice);
  if (told != told_.end() && told->second == chunk) return;
  told_[notice] = chunk;
  out.texts[notice] = reader_.read(reader_.chunks()[chunk]);
}

Replay::Output Replay::advance(double now_s) {
  Output out;
  if (playing_ && now_s_ >= 0) position_ += (now_s - now_s_) * speed_ / run_.step_s;
  now_s_ = now_s;
  const bool texts_are_told = jumped_;
  if (jumped_) tell_what_holds(out);
  const auto& chunks = reader_.chunks();
  for (; next_ < chunks.size() && static_cast<double>(places_[next_]) <= position_; ++next_) {
    const auto notice = notice_of(chunks[next_].kind);
    if (is_frame(chunks[next_])) emit_frame(chunks[next_], out);
    if (notice && !texts_are_told) tell(*notice, next_, out);
  }
  if (next_ >= chunks.size()) playing_ = false;
  return out;
}

void Replay::emit_frame(const Chunk& chunk, Output& out) {
  const std::string bytes = reader_.read(chunk);
  auto frame = decoder_.decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, table_);
  if (!frame || (jumped_ && !frame->restart)) return;
  if (!jumped_ && frame->restart && frame->generation == table_.generation()) make_difference(*frame, table_);
  jumped_ = false;
  table_.apply(*frame);
  at_ = places_[next_];
  out.frames.push_back(std::move(*frame));
}

}  // namespace aurasim::overseer
