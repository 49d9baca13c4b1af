#include "overseer/recording.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

namespace aurasim::overseer {
namespace {

constexpr std::array<char, 8> kMagic = {'A', 'U', 'R', 'A', 'R', 'E', 'C', '2'};
constexpr std::uint32_t kLargestChunk = 256U << 20U;
constexpr double kKeyFramePeriodS = 2;

struct ChunkHeader {
  std::uint8_t kind = 0;
  std::array<std::uint8_t, 3> zero{};
  std::uint32_t size = 0;
  std::uint32_t generation = 0;
  std::uint32_t zero_too = 0;
  std::int64_t step = 0;
  double time_s = 0;
};
static_assert(sizeof(ChunkHeader) == 32);

}  // namespace

RecordingWriter::RecordingWriter(const std::filesystem::path& file) : file_(file), out_(file, std::ios::binary) {
  out_.write(kMagic.data(), kMagic.size());
  if (!out_) throw BadRecording(fmt::format("{}: cannot be written", file.string()));
}

void RecordingWriter::write(ChunkKind kind, const std::string& text, double time_s) {
  write(kind, text.data(), text.size(), time_s);
}

void RecordingWriter::write(const WorldFrame& frame, double time_s) {
  table_.apply(frame);
  frames_.note(frame);
  const bool key = frame.restart || time_s >= next_key_s_;
  if (key) {
    frames_ = {};  // reset, so that the next frame is a key frame
    frames_.note(frame);
    next_key_s_ = time_s + kKeyFramePeriodS;
  }
  const Bytes bytes = frames_.encode(table_);
  write(key ? ChunkKind::kKeyFrame : ChunkKind::kFrame, bytes.data(), bytes.size(), time_s);
}

void RecordingWriter::write(ChunkKind kind, const void* bytes, std::size_t size, double time_s) {
  ChunkHeader header;
  header.kind = static_cast<std::uint8_t>(kind);
  header.size = static_cast<std::uint32_t>(size);
  header.generation = table_.generation();
  header.step = table_.stamp();
  header.time_s = time_s;
  out_.write(reinterpret_cast<const char*>(&header), sizeof header);
  out_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  if (kind == ChunkKind::kStatus) out_.flush();  // statuses come four times a second
  if (!out_) throw BadRecording(fmt::format("{}: cannot be written any more", file_.string()));
}

RecordingReader::RecordingReader(const std::filesystem::path& file) : file_(file), in_(file, std::ios::binary) {
  std::array<char, 8> magic{};
  in_.read(magic.data(), magic.size());
  if (!in_ || !std::equal(magic.begin(), magic.end() - 1, kMagic.begin()))
    throw BadRecording(fmt::format("{}: not a recording", file.string()));
  if (magic != kMagic) throw BadRecording(fmt::format("{}: a recording of another version", file.string()));
  const std::uint64_t end = std::filesystem::file_size(file);
  std::uint64_t at = magic.size();
  bool any_frame = false;
  for (ChunkHeader header; at + sizeof header <= end; at += sizeof header + header.size) {
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(reinterpret_cast<char*>(&header), sizeof header);
    const bool sound = in_ && header.kind >= 1 && header.kind <= 6 && header.size <= kLargestChunk &&
                       header.size <= end - at - sizeof header;
    if (!sound) break;
    const auto kind = static_cast<ChunkKind>(header.kind);
    if (kind == ChunkKind::kFrame && !any_frame) continue;  // a reader needs a key frame to start from
    any_frame = any_frame || kind == ChunkKind::kKeyFrame;
    chunks_.push_back({kind, header.generation, header.step, header.time_s, at + sizeof header, header.size});
  }
  in_.clear();
  if (!any_frame) throw BadRecording(fmt::format("{}: has no frame", file.string()));
}

std::string RecordingReader::read(const Chunk& chunk) {
  std::string bytes(chunk.size, '\0');
  in_.seekg(static_cast<std::streamoff>(chunk.offset));
  in_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in_) throw BadRecording(fmt::format("{}: cannot be read any more", file_.string()));
  return bytes;
}

}  // namespace aurasim::overseer
