// The pages about asks say what is declared.
#include "steering/ask_page.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "steering/ask.h"

namespace aurasim::steering {
namespace {

std::string asks_text_of_doc(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(std::filesystem::path(AURASIM_SOURCE_DIR) / "docs" / name, std::ios::binary).rdbuf();
  return text.str();
}

TEST(AsksOnPaper, ThePageSaysWhatIsDeclared) {
  const bool is_there =
      asks_text_of_doc("commands.md").find("-->\n" + asks_as_markdown() + "<!--") != std::string::npos;
  EXPECT_TRUE(is_there) << "after a change of asks: scripts/write_keys.sh";
}

TEST(AsksOnPaper, TheSchemaSaysWhatIsDeclared) {
  EXPECT_TRUE(asks_text_of_doc("aurasim-asks.schema.json") == ask_schema()) << "scripts/write_keys.sh";
}

TEST(AsksOnPaper, EveryFieldIsThere) {
  const std::string page = asks_as_markdown();
  for (const AskKind& kind : asks()) {
    EXPECT_NE(page.find("**`" + std::string(kind.name) + "`**"), std::string::npos);
    for (const Field& field : kind.fields) EXPECT_FALSE(field.help.empty()) << kind.name << "." << field.name;
  }
}

}  // namespace
}  // namespace aurasim::steering
