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

/// A key frame amid the others, as what it changes.
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
  const auto first = std::find_if(chunks.begin(), chunks.end(), is_frame);
  first_step_ = last_step_ = first->step;
  for (const Chunk& chunk : chunks) {
    if (!is_frame(chunk)) continue;
    first_step_ = std::min(first_step_, chunk.step);
    last_step_ = std::max(last_step_, chunk.step);
  }
  generation_ = first->generation;
  position_ = static_cast<double>(first->step);
}

void Replay::apply(const ReplayControl& control) {
  using Action = ReplayControl::Action;
  switch (control.action) {
    case Action::kPlay:
      if (next_ >= reader_.chunks().size()) seek(first_step_);
      playing_ = true;
      break;
    case Action::kPause:
      playing_ = false;
      break;
    case Action::kSpeed:
      speed_ = control.value;
      break;
    case Action::kSeek:
      seek(static_cast<core::Step>(
          std::clamp(control.value, static_cast<double>(first_step_), static_cast<double>(last_step_))));
      break;
  }
}

/// To the last key frame up to `step`, in the generation that is being shown if it went so far; advance() does the
/// rest.
void Replay::seek(core::Step step) {
  const auto& chunks = reader_.chunks();
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const Chunk& chunk = chunks[i];
    if (chunk.kind != ChunkKind::kKeyFrame || chunk.step > step) continue;
    const bool is_shown = chunk.generation == generation_;
    if (!best || (is_shown && chunks[*best].generation != generation_) ||
        (is_shown == (chunks[*best].generation == generation_) && chunk.step >= chunks[*best].step))
      best = i;
  }
  if (!best) best = static_cast<std::size_t>(std::find_if(chunks.begin(), chunks.end(), is_frame) - chunks.begin());
  next_ = *best;
  generation_ = chunks[next_].generation;
  position_ = static_cast<double>(std::max(step, chunks[next_].step));
  jumped_ = true;
}

Replay::Output Replay::advance(double now_s) {
  Output out;
  if (playing_ && now_s_ >= 0) position_ += (now_s - now_s_) * speed_ / run_.step_s;
  now_s_ = now_s;
  const auto& chunks = reader_.chunks();
  for (; next_ < chunks.size(); ++next_) {
    const Chunk& chunk = chunks[next_];
    if (is_frame(chunk) && chunk.generation != generation_) {  // the run was reset here
      if (!playing_) break;
      generation_ = chunk.generation;
      position_ = static_cast<double>(chunk.step);
    }
    if (is_frame(chunk) && static_cast<double>(chunk.step) > position_) break;
    emit(chunk, out);
  }
  if (next_ >= chunks.size()) playing_ = false;
  return out;
}

void Replay::emit(const Chunk& chunk, Output& out) {
  if (is_frame(chunk)) return emit_frame(chunk, out);
  if (const auto notice = notice_of(chunk.kind)) out.texts[*notice] = reader_.read(chunk);
}

void Replay::emit_frame(const Chunk& chunk, Output& out) {
  const std::string bytes = reader_.read(chunk);
  auto frame = decode_frame({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, table_);
  if (!frame || (jumped_ && !frame->restart)) return;
  if (!jumped_ && frame->restart && frame->generation == table_.generation()) make_difference(*frame, table_);
  jumped_ = false;
  table_.apply(*frame);
  out.frames.push_back(std::move(*frame));
}

}  // namespace aurasim::overseer
