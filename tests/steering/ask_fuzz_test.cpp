// Random JSON: it is read or refused, and nothing else is thrown. The seed is printed.
#include <iostream>
#include <random>

#include <gtest/gtest.h>

#include "steering/ask_samples.h"

namespace aurasim::steering::testing {
namespace {

class AskFuzz : public ::testing::Test {
 protected:
  AskFuzz() { std::cout << "seed " << kSeed << "\n"; }

  std::size_t below(std::size_t count) { return random_() % count; }

  Json random_number() {
    static const std::vector<Json> kNumbers = {0,    1,    -1,   0.5,       1e-320, 1e300, 1e308, std::uint64_t(-1),
                                               1e15, -0.0, 7e-4, 4294967296};
    return kNumbers[below(kNumbers.size())];
  }

  Json random_value(int depth) {
    switch (below(depth > 3 ? 4 : 7)) {
      case 0:
        return random_number();
      case 1:
        return nullptr;
      case 2:
        return below(2) == 0;
      case 3: {
        static const std::vector<std::string> kTexts = {"",
                                                        "sphere",
                                                        "mesh",
                                                        "hull",
                                                        "../x",
                                                        "a",
                                                        "00000000000000ff",
                                                        "\xff\xfe",
                                                        std::string(300, 'x'),
                                                        std::string("\0", 1)};
        return kTexts[below(kTexts.size())];
      }
      case 4:
      case 5: {
        Json list = Json::array();
        for (std::size_t i = below(5); i > 0; --i)
          list.push_back(below(4) == 0 ? random_value(depth + 1) : random_number());
        return list;
      }
      default: {
        Json object = Json::object();
        for (std::size_t i = below(4); i > 0; --i) object[random_name()] = random_value(depth + 1);
        return object;
      }
    }
  }

  std::string random_name() {
    const AskKind& kind = asks()[below(asks().size())];
    const ShapeKind& shape = shapes()[below(shapes().size())];
    switch (below(4)) {
      case 0:
        return "kind";
      case 1:
        return std::string(shape.fields[below(shape.fields.size())].name);
      case 2:
        return kind.fields.empty() ? "\xff" : std::string(kind.fields[below(kind.fields.size())].name);
      default:
        return "at";
    }
  }

  /// Counts what is read. Fails if anything but a refusal is thrown.
  void read(const Json& json) {
    for (const MeshFiles files : {MeshFiles::kAllowed, MeshFiles::kRefused}) {
      try {
        Ask ask = read_ask(json, files);
        if (const auto* const command = std::get_if<core::Ask>(&ask.what)) {
          const bool is_back = std::holds_alternative<core::Load>(*command) && json.at("kind") == "back";
          EXPECT_TRUE(is_back || problem_with(*command).empty()) << json;
        }
        ++read_;
        look_up_static(ask, {});
      } catch (const BadAsk& bad) {
        EXPECT_NE(std::string(bad.what()), "");
        EXPECT_LT(std::string(bad.what()).size(), 1000U);
      }
    }
  }

  static constexpr unsigned kSeed = 17;
  std::mt19937 random_{kSeed};
  int read_ = 0;
};

TEST_F(AskFuzz, RandomValuesInSoundAsksAreReadOrRefused) {
  for (int i = 0; i < 100'000; ++i) {
    Json ask = whole_ask(asks()[below(asks().size())]);
    for (std::size_t k = 1 + below(2); k > 0; --k) {
      const std::string name = random_name();
      if (below(3) == 0) {
        ask.erase(name);
      } else if (below(4) == 0 && ask.contains("shape") && ask["shape"].is_object()) {
        ask["shape"][name] = random_value(1);
      } else {
        ask[name] = random_value(0);
      }
    }
    read(ask);
  }
  EXPECT_GT(read_, 2'000);
  EXPECT_LT(read_, 150'000);
}

TEST_F(AskFuzz, RandomJsonIsRefused) {
  for (int i = 0; i < 50'000; ++i) read(random_value(0));
  std::string deep = R"({"kind":"impulse","body":)" + std::string(30'000, '[') + std::string(30'000, ']') + "}";
  read(Json::parse(deep));
  EXPECT_LT(read_, 1'000);
}

}  // namespace
}  // namespace aurasim::steering::testing
