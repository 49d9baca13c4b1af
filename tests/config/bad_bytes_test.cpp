// Files that are no YAML, no text, or made to hurt.
#include <chrono>

#include <sys/stat.h>

#include "config/workspace.h"

namespace aurasim::config {
namespace {

class BadBytes : public testing::Test {
 protected:
  std::vector<std::string> errors(const std::string& bytes) const { return workspace_.launch_errors(bytes); }

  const Workspace workspace_;
};

TEST_F(BadBytes, AnEmptyFileHasNoKeys) {
  expect_errors(
      errors(""),
      {"launch.yaml:1:1: the file: found nothing, allowed: a map of scene, regions, exchange, exchange_limit, time"});
  expect_errors(errors("# only a comment\n"), {"launch.yaml:"});
}

TEST_F(BadBytes, ASyntaxErrorHasItsPlace) {
  expect_errors(errors("scene: scene.yaml\nregions: {count: [1, 2}\n"),
                {"launch.yaml:2:23: the file: found illegal flow end, allowed: one YAML document"});
  expect_errors(errors("scene: 'open\n"), {"launch.yaml:1:13: the file: found illegal EOF in scalar"});
  expect_errors(errors("scene: a\n\tregions: b\n"), {"launch.yaml:"});
}

TEST_F(BadBytes, BinaryRubbishIsRefusedAtItsFirstByte) {
  expect_errors(errors(std::string("scene: a\nre\0gions", 17)),
                {"launch.yaml:2:3: the file: found the byte 0x00, allowed: printable text in UTF-8"});
  expect_errors(errors("\x7f"
                       "ELF"),
                {"launch.yaml:1:1: the file: found the byte 0x7f"});
  expect_errors(errors("scene: \xff\xfe"), {"launch.yaml:1:8: the file: found the byte 0xff"});
  expect_errors(errors("scene: \xe2\x82"), {"launch.yaml:1:8: the file: found the byte 0xe2"});
}

TEST_F(BadBytes, TheEndOfTransmissionByteDoesNotHideTheRest) {
  expect_errors(errors(std::string(kSmallLaunch) + "\x04\nnonsense: 1\n"),
                {"launch.yaml:3:1: the file: found the byte 0x04"});
}

TEST_F(BadBytes, ADirectoryIsNoFile) {
  const auto found = workspace_.errors_of([&] { read_launch(workspace_.folder()); });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0],
              testing::HasSubstr(":1:1: the file: found nothing to read: it is a directory, allowed: a YAML"));
}

TEST_F(BadBytes, APipeIsNotWaitedFor) {
  const auto pipe = workspace_.folder() / "pipe.yaml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_errors(workspace_.errors_of([&] { read_launch(pipe); }),
                {"pipe.yaml:1:1: the file: found nothing to read: it is not a regular file"});
}

TEST_F(BadBytes, AFileThatDoesNotExistIsNamed) {
  expect_errors(workspace_.errors_of([&] { read_launch(workspace_.folder() / "gone.yaml"); }),
                {"gone.yaml:1:1: the file: found nothing to read: No such file or directory"});
}

TEST_F(BadBytes, ASecondDocumentIsRefused) {
  expect_errors(errors(std::string(kSmallLaunch) + "---\na: 1\n"),
                {"launch.yaml:3:1: the file: found a second document, allowed: one YAML document"});
}

TEST_F(BadBytes, AKeyThatIsAListIsRefused) {
  expect_errors(errors("? [a, b]\n: 1\n"), {"launch.yaml:1:3: the file: found a key that is not text"});
}

TEST_F(BadBytes, AnUnknownAliasIsRefused) { expect_errors(errors("scene: *nobody\n"), {"launch.yaml:1:8: the file:"}); }

TEST_F(BadBytes, AnAliasInsideItsOwnAnchorIsRefused) {
  expect_errors(errors("scene: &a [*a]\n"),
                {"launch.yaml:1:12: the file: found an alias inside the value that it names"});
}

TEST_F(BadBytes, AnAliasBombGoesOffInNobodysMemory) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    bomb.append("a").append(std::to_string(i)).append(": &a").append(std::to_string(i)).append(" [");
    for (int k = 0; k < 10; ++k) bomb.append(k == 0 ? "*a" : ", *a").append(std::to_string(i - 1));
    bomb.append("]\n");
  }
  expect_errors(errors(bomb), {"launch.yaml:6:"});
}

TEST_F(BadBytes, DeepNestingIsRefused) {
  const auto found = errors("scene: " + std::string(100'000, '['));
  ASSERT_EQ(found.size(), 1u);
}

TEST_F(BadBytes, AFileBeyondTheLimitIsNotRead) {
  const auto file = workspace_.write("big.yaml", std::string((16u << 20) + 1, '#'));
  expect_errors(workspace_.errors_of([&] { read_launch(file); }),
                {"big.yaml:1:1: the file: found nothing to read: it has 16777217 bytes, at most 16777216 are read"});
}

TEST_F(BadBytes, AFileOfTooManyValuesIsRefused) {
  std::string text = "scene: [";
  for (int i = 0; i < 1'000'001; ++i) text += "1,";
  expect_errors(errors(text + "1]\n"), {"launch.yaml:1:"});
}

}  // namespace
}  // namespace aurasim::config
