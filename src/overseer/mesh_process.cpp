#include "overseer/mesh_process.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "host/child_program.h"

namespace aurasim::overseer {
namespace {

constexpr std::string_view kMesh = "AURAMESH";
constexpr std::string_view kWhyNot = "WHY NOT ";
constexpr std::size_t kMostBytes = std::size_t{256} << 20U;
constexpr std::size_t kMostMemory = std::size_t{2} << 30U;

template <class Number>
void put(Number value, std::string& to) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Number>
Number take(std::string_view& from) {
  Number value{};
  std::memcpy(&value, from.data(), sizeof value);
  from.remove_prefix(sizeof value);
  return value;
}

/// Ending of the file's name, if it is plain. No other part of the name that a client gives reaches a command line.
std::string ending_of(const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  const bool plain =
      ending.size() > 1 && ending.size() < 8 &&
      std::all_of(ending.begin() + 1, ending.end(), [](unsigned char c) { return std::isalnum(c) != 0; });
  return plain ? ending : "";
}

MeshOrWhy outcome(const host::ChildResult& result, std::chrono::milliseconds limit) {
  if (result.timed_out) return fmt::format("it takes longer than {} s", static_cast<double>(limit.count()) / 1000);
  if (result.signal != 0) return fmt::format("it breaks its reader (signal {})", result.signal);
  if (result.exit_code != 0) return fmt::format("its reader fails (exit code {})", result.exit_code);
  return mesh_of_bytes(result.output);
}

}  // namespace

std::string mesh_bytes(const MeshOrWhy& mesh_or_why) {
  if (const auto* why = std::get_if<std::string>(&mesh_or_why)) return std::string(kWhyNot) + *why;
  const auto& mesh = std::get<core::TriangleMesh>(mesh_or_why);
  std::string bytes(kMesh);
  put(static_cast<std::uint32_t>(mesh.points.size()), bytes);
  put(static_cast<std::uint32_t>(mesh.triangles.size()), bytes);
  for (const core::Vec3& p : mesh.points) {
    for (int i = 0; i < 3; ++i) put(p[i], bytes);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) put(corner, bytes);
  }
  return bytes;
}

MeshOrWhy mesh_of_bytes(std::string_view bytes) {
  if (bytes.starts_with(kWhyNot)) return std::string(bytes.substr(kWhyNot.size()));
  const std::string no_mesh = "its reader has given no mesh";
  if (!bytes.starts_with(kMesh) || bytes.size() < kMesh.size() + 8) return no_mesh;
  bytes.remove_prefix(kMesh.size());
  const std::uint64_t points = take<std::uint32_t>(bytes), triangles = take<std::uint32_t>(bytes);
  if (bytes.size() != points * 24 + triangles * 12) return no_mesh;
  core::TriangleMesh mesh;
  mesh.points.resize(points);
  mesh.triangles.resize(triangles);
  for (core::Vec3& p : mesh.points) {
    for (int i = 0; i < 3; ++i) p[i] = take<double>(bytes);
    if (!p.allFinite()) return no_mesh;
  }
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) {
      corner = take<std::uint32_t>(bytes);
      if (corner >= points) return no_mesh;
    }
  }
  return mesh;
}

MeshOrWhy MeshProcess::read(const std::string& name, std::string_view bytes) const {
  return outcome(
      host::run_child({{program, "mesh-loader", "read", "mesh" + ending_of(name)}, limit, kMostBytes, kMostMemory},
                      bytes),
      limit);
}

MeshOrWhy read_mesh_apart(const std::string& name, std::string_view bytes) { return MeshProcess{}.read(name, bytes); }

MeshOrWhy MeshProcess::decompose(const core::TriangleMesh& mesh) const {
  return outcome(host::run_child({{program, "mesh-loader", "parts"}, limit, kMostBytes, kMostMemory}, mesh_bytes(mesh)),
                 limit);
}

}  // namespace aurasim::overseer
