// What a page with its WebSocket is sent, and what becomes of what it sends.
#include "overseer/web_fixture.h"

namespace aurasim::overseer {
namespace {

TEST_F(Web, APageGetsHelloThenTheSceneThenAKeyFrame) {
  serve();
  show(5);
  show(5);
  Page page(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  ASSERT_GE(page.order.size(), 3U);
  EXPECT_EQ(page.order[0], "hello");
  EXPECT_EQ(page.order[1], "scene");
  EXPECT_EQ(page.order[2], "frame");
  EXPECT_EQ(page.world.stamp, 6);
  EXPECT_EQ(page.world.bodies.size(), 5U);
  show(5);
  ASSERT_TRUE(page.wait_until([&] { return page.world.stamp == 9; }));
  EXPECT_EQ(page.world.key_frames, 1);
  server_->publish(Notice::kStatus, R"({"type":"status"})");
  EXPECT_TRUE(page.wait_until([&] { return page.has("status"); }));
}

TEST_F(Web, CommandsReachTheOwnerAndRepliesThePageThatAsked) {
  serve();
  Page page(port()), other(port());
  page.send(Json{{"type", "command"}, {"request", "r1"}, {"command", {{"kind", "step"}, {"count", 7}}}});
  std::vector<PageRequest> requests;
  ASSERT_TRUE(holds_in_time([&] {
    for (PageRequest& request : server_->take_requests()) requests.push_back(std::move(request));
    return !requests.empty();
  }));
  const auto& asked = std::get<Request>(requests[0]);
  EXPECT_EQ(std::get<steering::Steer>(asked.ask.what).count, 7);
  server_->answer({asked.client, asked.id, true, "done", {{"hit", false}}});
  ASSERT_TRUE(page.wait_until([&] { return page.has("reply"); }));
  EXPECT_EQ(page.latest["reply"],
            Json({{"type", "reply"}, {"request", "r1"}, {"ok", true}, {"text", "done"}, {"result", {{"hit", false}}}}));
  EXPECT_FALSE(other.wait_until([&] { return other.has("reply"); }, 200ms));
}

TEST_F(Web, AWatchedBodyIsToldWithEachStatusUntilItIsGone) {
  serve();
  show(3);
  Page page(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  page.send(Json{{"type", "watch"}, {"slot", 2}});
  ASSERT_TRUE(page.wait_until([&] { return page.has("body"); }));
  EXPECT_EQ(page.latest["body"].at("id"), 102);
  WorldFrame frame;
  frame.stamp = 9;
  frame.deleted = {2};
  server_->show(frame);
  server_->publish(Notice::kStatus, R"({"type":"status"})");
  EXPECT_TRUE(page.wait_until([&] { return page.latest["body"].contains("gone"); }));
}

TEST_F(Web, OverlaysGoToThePagesThatWantThem) {
  serve();
  Page page(port()), other(port());
  page.send(Json{{"type", "show"}, {"auras", true}});
  ASSERT_TRUE(holds_in_time([&] { return server_->wanted().auras; }));
  const std::vector<AuraDisc> auras = {{1, 2}};
  server_->show_overlays(encode_overlays(auras, {}, {}));
  EXPECT_TRUE(page.wait_until([&] { return !page.overlays.empty(); }));
  EXPECT_FALSE(other.wait_until([&] { return !other.overlays.empty(); }, 100ms));
}

TEST_F(Web, AHiddenPageIsSentNothingAndMissesNothing) {
  serve();
  show(50);
  Page page(port()), other(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  page.send(Json{{"type", "view"}, {"hidden", true}});
  page.ask({{"kind", "nonsense"}});  // replies come all the same, and then it is known to be hidden
  const std::uint64_t bytes = page.bytes;
  for (int i = 0; i < 20; ++i) {
    show(50);
    server_->publish(Notice::kStatus, R"({"type":"status"})");
  }
  ASSERT_TRUE(
      other.wait_until([&] { return other.world.stamp == static_cast<double>(stamp_) && other.has("status"); }));
  EXPECT_FALSE(page.wait_until([&] { return page.bytes > bytes; }, 300ms));
  page.send(Json{{"type", "view"}});
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == static_cast<double>(stamp_) && page.has("status"); }));
  EXPECT_EQ(page.world.bodies.at(7).p.x(), static_cast<double>(stamp_));
}

}  // namespace
}  // namespace aurasim::overseer
