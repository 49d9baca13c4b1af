// A run as pages saw it, in a file: texts and frames as in docs/viewer.md, each with its step and time.
//
// "AURAREC2", then chunks: kind u8, zero u8[3], size u32, generation u32, zero u32, step i64, time f64 (s since the
// recording began), then `size` bytes. Little-endian. Every few seconds a key frame, so that a reader can start there.
// The index is made on opening, by jumping from chunk to chunk: a recording that was cut off is whole up to there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "overseer/frame_codec.h"

namespace aurasim::overseer {

enum class ChunkKind : std::uint8_t {
  kAbout = 1,
  kScene = 2,
  kMap = 3,
  kStatus = 4,
  kFrame = 5,
  kKeyFrame = 6,
  kMoves = 7
};

struct Chunk {
  ChunkKind kind = ChunkKind::kFrame;
  core::Generation generation = 0;
  core::Step step = 0;
  double time_s = 0;
  std::uint64_t offset = 0;  ///< offset of its bytes in the file
  std::uint32_t size = 0;
};

class BadRecording : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class RecordingWriter {
 public:
  /// Throws BadRecording when the file cannot be written.
  explicit RecordingWriter(const std::filesystem::path& file);

  void write(ChunkKind kind, const std::string& text, double time_s);
  void write(const WorldFrame& frame, double time_s);

 private:
  void write(ChunkKind kind, const void* bytes, std::size_t size, double time_s);

  std::filesystem::path file_;
  std::ofstream out_;
  SlotTable table_;
  ClientFrames frames_;
  double next_key_s_ = 0;
};

class RecordingReader {
 public:
  /// Opens a recording. Throws BadRecording when the file is none, or has no frame.
  explicit RecordingReader(const std::filesystem::path& file);

  const std::vector<Chunk>& chunks() const { return chunks_; }
  /// Reads a chunk. Throws BadRecording when the file has changed.
  std::string read(const Chunk& chunk);

 private:
  std::filesystem::path file_;
  std::ifstream in_;
  std::vector<Chunk> chunks_;
};

}  // namespace aurasim::overseer
