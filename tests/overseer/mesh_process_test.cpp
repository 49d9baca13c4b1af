// Meshes are read by a process of their own: what a file does to it, and what becomes of us.
#include "overseer/mesh_process.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/meshes.h"
#include "host/child_program.h"

namespace aurasim::overseer {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

class MeshReading : public ::testing::Test {
 protected:
  /// A program that does this instead of reading.
  MeshProcess process_that(const std::string& does) {
    std::ofstream(script_) << "#!/bin/sh\n" << does << "\n";
    ::chmod(script_.c_str(), 0755);
    return {.program = script_, .limit = 60s};
  }
  void TearDown() override { std::remove(script_.c_str()); }

  static std::string why_not(const MeshOrWhy& mesh) {
    const auto* why = std::get_if<std::string>(&mesh);
    return why == nullptr ? "it is read" : *why;
  }

  MeshProcess process_{.program = AURASIM_BINARY_DIR "/aurasim", .limit = 60s};
  std::string script_ = ::testing::TempDir() + "/aurasim_mesh_" + std::to_string(::getpid());
};

TEST_F(MeshReading, GivesWhatTheLibraryGives) {
  const MeshOrWhy here = config::read_mesh("a.obj", kTetrahedron), there = process_.read("a.obj", kTetrahedron);
  ASSERT_TRUE(std::holds_alternative<core::TriangleMesh>(there)) << why_not(there);
  EXPECT_EQ(std::get<core::TriangleMesh>(there).points, std::get<core::TriangleMesh>(here).points);
  EXPECT_EQ(std::get<core::TriangleMesh>(there).triangles, std::get<core::TriangleMesh>(here).triangles);
  EXPECT_EQ(why_not(process_.read("a.exe", "x")), why_not(config::read_mesh("a.exe", "x")));
  EXPECT_EQ(why_not(process_.read("-h; reboot.$(x)", "x")), why_not(config::read_mesh("a", "x")));
}

TEST_F(MeshReading, ANestOfBracketsIsRefusedAndWeLive) {
  EXPECT_THAT(why_not(process_.read("a.gltf", std::string(200'000, '['))), HasSubstr("nested"));
  // As a binary glTF nobody looks at its brackets before assimp does.
  std::string glb("glTF\x02\0\0\0", 8);
  const std::string json(2'000'000, '[');
  for (const std::uint32_t n : {20 + 2'000'000U, 2'000'000U, 0x4E4F534AU})
    glb.append(reinterpret_cast<const char*>(&n), 4);
  EXPECT_NE(why_not(process_.read("a.glb", glb + json)), "it is read");
}

TEST_F(MeshReading, AReaderThatBreaksIsTheMeshesFault) {
  EXPECT_THAT(why_not(process_that("kill -SEGV $$").read("a.obj", kTetrahedron)), HasSubstr("signal 11"));
  EXPECT_THAT(why_not(process_that("exit 3").read("a.obj", std::string(1 << 20, ' '))), HasSubstr("exit code 3"));
  EXPECT_THAT(why_not(process_that("echo nonsense").read("a.obj", kTetrahedron)), HasSubstr("no mesh"));
}

TEST_F(MeshReading, AReaderThatTakesTooLongIsEnded) {
  MeshProcess slow = process_that("exec sleep 1000");
  slow.limit = 200ms;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(why_not(slow.read("a.obj", kTetrahedron)), HasSubstr("longer than 0.2 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 60s);
}

TEST_F(MeshReading, AReaderThatSaysTooMuchIsEnded) {
  const MeshProcess endless = process_that("exec yes");
  const host::ChildResult result = host::run_child({{endless.program}, 60s, 1 << 20, std::size_t{1} << 30U}, "");
  EXPECT_TRUE(result.timed_out);
  EXPECT_NE(result.signal, 0);
}

TEST_F(MeshReading, PartsAreFoundThere) {
  const MeshOrWhy whole = process_.read("a.obj", kTetrahedron);
  ASSERT_TRUE(std::holds_alternative<core::TriangleMesh>(whole)) << why_not(whole);
  const MeshOrWhy parts = process_.decompose(std::get<core::TriangleMesh>(whole));
  EXPECT_NE(why_not(parts), "its reader has given no mesh");
}

TEST(MeshBytes, SpoiltOnesAreRefused) {
  const std::string bytes = mesh_bytes(config::read_mesh("a.obj", kTetrahedron));
  ASSERT_TRUE(std::holds_alternative<core::TriangleMesh>(mesh_of_bytes(bytes)));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_TRUE(std::holds_alternative<std::string>(mesh_of_bytes(std::string_view(bytes).substr(0, size)))) << size;
  std::string beyond = bytes;
  beyond.back() = 1;  // a corner that there is not
  EXPECT_TRUE(std::holds_alternative<std::string>(mesh_of_bytes(beyond)));
}

}  // namespace
}  // namespace aurasim::overseer
