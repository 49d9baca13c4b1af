// The bytes of a saved world.
#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zstd.h>

#include "cut/cut_file.h"
#include "cut/saved_shapes.h"
#include "messages/wire_bytes.h"

namespace aurasim::cut {
namespace {

using nlohmann::json;

constexpr char kMagic[] = "AURACUT3";  // the last character is the number of the format
constexpr std::size_t kMagicBytes = 8, kFormatAt = 7;
/// Level of zstd. Level 1 packs a world of 1.5 MB into 540 kB; level 3 packs it into 535 kB, and takes 1.65 times as
/// long. With level 3 packing took 2% of a coupled node's time.
constexpr int kLevel = 1;
constexpr std::size_t kMostBytes = std::size_t{2} << 30U;  // uncompressed: some ten million contact points
constexpr std::size_t kMostGrowth = 200;  // decompressed size over compressed size; equal piles reach 50
constexpr std::size_t kMostOfHeader = 64 << 10;
constexpr std::size_t kOrdersAtOnce = 1000;
/// Most states for which a cluster may have been under way, or for which births may be known ahead: many times more
/// than with the largest lookahead. A run computes clusters under way through these states before it begins.
constexpr core::Step kMostStatesBetween = 10'000;

/// Types of the pieces after the header. Each piece is stored with its length.
enum class Piece : std::uint8_t { kEnd, kBodies, kUnderWay, kOrders, kShape, kMesh, kSetpoints };

void put_number(std::string& out, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(number >> (8 * i) & 0xff));
}

template <class Bytes>
void put(std::string& out, const Bytes& bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) throw std::runtime_error("the world is too large");
  put_number(out, static_cast<std::uint32_t>(bytes.size()));
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

template <class Bytes>
void put(std::string& out, Piece piece, const Bytes& bytes) {
  out.push_back(static_cast<char>(piece));
  put(out, bytes);
}

class Reader {
 public:
  explicit Reader(const std::string& bytes) : rest_(bytes) {}

  std::uint8_t byte() { return static_cast<std::uint8_t>(take(1)[0]); }
  std::string_view bytes() {
    const std::string_view length = take(4);
    std::uint32_t count = 0;
    for (int i = 3; i >= 0; --i) count = count << 8 | static_cast<std::uint8_t>(length[static_cast<std::size_t>(i)]);
    return take(count);
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  std::string_view take(std::size_t count) {
    if (rest_.size() < count) throw BadCut("damaged: it ends in the middle");
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  std::string_view rest_;
};

std::span<const std::uint8_t> octets(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

std::string compressed(const std::string& bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress2(context.get(), out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  out.resize(size);
  return out;
}

/// Decompresses at most `enough` bytes. Takes memory only for bytes that are really there, whatever size the frame
/// claims.
std::string decompressed(std::string_view bytes, std::size_t enough = kMostBytes + 1) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, 27);
  std::string out, chunk(ZSTD_DStreamOutSize(), '\0');
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  const std::size_t most = std::min(kMostBytes, (1 << 20) + kMostGrowth * bytes.size());
  std::size_t left = 1;
  while (left != 0) {
    ZSTD_outBuffer to{chunk.data(), chunk.size(), 0};
    left = ZSTD_decompressStream(context.get(), &to, &in);
    if (ZSTD_isError(left) != 0) throw BadCut(fmt::format("damaged: {}", ZSTD_getErrorName(left)));
    if (left != 0 && to.pos == 0 && in.pos == in.size) throw BadCut("cut short");
    out.append(chunk.data(), to.pos);
    if (out.size() >= enough) return out;
    if (out.size() > most) throw BadCut("damaged: it becomes larger than any world of its size");
  }
  if (in.pos != in.size) throw BadCut("damaged: something follows its end");
  return out;
}

json header_of(const SavedWorld& world) {
  const Identity& id = world.identity;
  return {{"program", id.program},
          {"launch", id.launch},
          {"scene", id.scene},
          {"physics", id.physics},
          {"world", id.world},
          {"part", world.part},
          {"parts", world.parts},
          {"save", world.save},
          {"run", world.run},
          {"saved_ms", world.saved_ms},
          {"step", world.cut.step},
          {"births_known", world.cut.births_known},
          {"last_order", world.cut.last_order},
          {"bodies", core::body_count(world.cut)}};
}

/// Reads a whole number up to `most`. Checks its type, because the JSON library would convert other numbers.
std::uint64_t whole(const json& header, const char* key,
                    std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
  const json& number = header.at(key);
  if (number.is_number_unsigned() && number.get<std::uint64_t>() <= most) return number.get<std::uint64_t>();
  throw BadCut(fmt::format("damaged: its header: {} is no whole number from 0 to {}", key, most));
}

SavedWorld from_header(std::string_view text) {
  constexpr std::uint64_t kMostSteps = std::uint64_t{1} << 52, kMostRegions = 1 << 20;
  constexpr std::uint64_t kMostMs = std::uint64_t{1} << 52;
  SavedWorld world;
  try {
    const json header = json::parse(text);
    Identity& id = world.identity;
    header.at("program").get_to(id.program);
    header.at("launch").get_to(id.launch);
    header.at("scene").get_to(id.scene);
    header.at("physics").get_to(id.physics);
    id.world = whole(header, "world");
    world.parts = static_cast<std::uint32_t>(whole(header, "parts", kMostRegions));
    world.part = static_cast<std::uint32_t>(whole(header, "part", kMostRegions));
    world.save = whole(header, "save");
    if (header.contains("run")) world.run = whole(header, "run");
    if (header.contains("saved_ms")) world.saved_ms = static_cast<std::int64_t>(whole(header, "saved_ms", kMostMs));
    world.cut.step = static_cast<core::Step>(whole(header, "step", kMostSteps));
    world.cut.births_known = static_cast<core::Step>(whole(header, "births_known", kMostSteps));
    world.cut.last_order = whole(header, "last_order");
  } catch (const json::exception& error) {
    throw BadCut(fmt::format("damaged: its header: {}", error.what()));
  }
  if (world.cut.births_known > world.cut.step + kMostStatesBetween) {
    throw BadCut(fmt::format("damaged: its header: births are known up to state {}, and it is of state {}",
                             world.cut.births_known, world.cut.step));
  }
  if (world.part >= world.parts) {
    throw BadCut(fmt::format("damaged: its header: there is no part {} of {}", world.part, world.parts));
  }
  return world;
}

core::HandOff letter(core::Step stamp, const core::ClusterState& cluster) {
  core::HandOff letter;
  letter.stamp = stamp;
  letter.sequence = 1;
  letter.cluster = cluster;
  return letter;
}

template <class Message>
Message sound(messages::Decoded<Message> decoded, const char* what) {
  if (auto* message = std::get_if<Message>(&decoded)) return std::move(*message);
  throw BadCut(fmt::format("damaged: {}: {}", what, name_of(std::get<messages::WireError>(decoded))));
}

void take(Piece piece, std::string_view bytes, messages::WireBytes& wire, core::WorldCut& cut) {
  switch (piece) {
    case Piece::kBodies:
      cut.bodies = sound(wire.hand_off(octets(bytes), {}), "its bodies").cluster;
      return;
    case Piece::kUnderWay: {
      core::HandOff hand_off = sound(wire.hand_off(octets(bytes), {}), "a cluster under way");
      cut.under_way.push_back({hand_off.stamp, std::move(hand_off.cluster)});
      return;
    }
    case Piece::kOrders: {
      const core::AuraBatch batch = sound(wire.aura(octets(bytes), {}), "its orders");
      cut.orders.insert(cut.orders.end(), batch.orders.begin(), batch.orders.end());
      return;
    }
    case Piece::kShape:
      cut.shapes.push_back(decode_shape(bytes));
      return;
    case Piece::kMesh: {
      messages::NamedMesh named = sound(wire.mesh(octets(bytes)), "a mesh");
      cut.meshes.push_back({named.hash, std::move(named.mesh)});
      return;
    }
    case Piece::kSetpoints:
      cut.setpoints.push_back(sound(wire.setpoints(octets(bytes)), "its setpoints"));
      return;
    case Piece::kEnd:
      return;
  }
  throw BadCut("damaged: it has a piece of no known kind");
}

}  // namespace

std::string encode(const SavedWorld& world) {
  const core::WorldCut& cut = world.cut;
  messages::WireBytes wire;
  std::string bytes;
  put(bytes, header_of(world).dump());
  if (!cut.bodies.bodies.empty()) put(bytes, Piece::kBodies, wire.of(letter(cut.step, cut.bodies)));
  for (const core::UnderWay& one : cut.under_way) {
    put(bytes, Piece::kUnderWay, wire.of(letter(one.stamp, one.cluster)));
  }
  for (std::size_t first = 0; first < cut.orders.size(); first += kOrdersAtOnce) {
    core::AuraBatch batch;
    const auto begin = cut.orders.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(kOrdersAtOnce, cut.orders.size() - first);
    batch.orders.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
    put(bytes, Piece::kOrders, wire.of(batch));
  }
  for (const core::SavedShape& shape : cut.shapes) put(bytes, Piece::kShape, encode_shape(shape));
  for (const core::SavedMesh& mesh : cut.meshes)
    put(bytes, Piece::kMesh, wire.of(messages::NamedMesh{mesh.hash, mesh.mesh}));
  for (const core::Setpoints& setpoints : cut.setpoints) put(bytes, Piece::kSetpoints, wire.of(setpoints));
  bytes.push_back(static_cast<char>(Piece::kEnd));
  return std::string(kMagic, kMagicBytes) + compressed(bytes);
}

namespace {

/// The bytes after the magic number. Checks type and format.
std::string_view after_magic(const std::string& bytes) {
  if (bytes.size() < kMagicBytes || std::memcmp(bytes.data(), kMagic, kFormatAt) != 0) {
    throw BadCut("this is no saved world");
  }
  if (bytes[kFormatAt] != kMagic[kFormatAt]) {
    throw BadCut(fmt::format("in format {}, and this program reads format {}", bytes[kFormatAt], kMagic[kFormatAt]));
  }
  return std::string_view(bytes).substr(kMagicBytes);
}

void check_under_way(const core::WorldCut& cut) {
  for (const core::UnderWay& one : cut.under_way) {
    if (one.stamp <= cut.step && one.stamp >= cut.step - kMostStatesBetween) continue;
    throw BadCut(fmt::format("damaged: a cluster that left in state {} is under way in state {}", one.stamp, cut.step));
  }
}

}  // namespace

SavedWorld decode_header(const std::string& bytes) {
  const std::string inside = decompressed(after_magic(bytes), kMostOfHeader);
  return from_header(Reader(inside).bytes());
}

SavedWorld decode(const std::string& bytes) {
  const std::string inside = decompressed(after_magic(bytes));
  Reader reader(inside);
  SavedWorld world = from_header(reader.bytes());
  messages::WireBytes wire;
  for (auto piece = static_cast<Piece>(reader.byte()); piece != Piece::kEnd;
       piece = static_cast<Piece>(reader.byte())) {
    take(piece, reader.bytes(), wire, world.cut);
  }
  if (!reader.is_at_end()) throw BadCut("damaged: something follows its end");
  check_under_way(world.cut);
  return world;
}

}  // namespace aurasim::cut
