// Nothing leaves the machine: a capture on every interface while two regions and an observer talk.
#include <cerrno>
#include <cstring>
#include <map>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <unistd.h>

#include "messages/control_samples.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;

/// RTPS ports of one domain: 7400 + 250 * domain and the 249 after it.
std::uint32_t first_port() { return 7400 + 250 * own_domain(); }

/// Sees every packet on every interface. Needs CAP_NET_RAW.
class Capture {
 public:
  Capture() : socket_(socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP))) {
    const int bytes = 64 << 20;
    if (socket_ >= 0 && setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0) {
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    }
  }
  ~Capture() {
    if (socket_ >= 0) {
      close(socket_);
    }
  }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  bool works() const { return socket_ >= 0; }

  /// Packets of the domain seen so far, by interface.
  std::map<std::string, int> packets() {
    unsigned char packet[256];
    sockaddr_ll from{};
    socklen_t length = sizeof from;
    while (true) {
      const auto size =
          recvfrom(socket_, packet, sizeof packet, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &length);
      if (size < 0) {
        return packets_;
      }
      if (is_of_the_domain(packet, static_cast<std::size_t>(size))) {
        char name[IF_NAMESIZE] = "?";
        if_indextoname(static_cast<unsigned>(from.sll_ifindex), name);
        ++packets_[name];
      }
    }
  }

 private:
  static bool is_of_the_domain(const unsigned char* packet, std::size_t size) {
    iphdr ip{};
    udphdr udp{};
    if (size < sizeof ip) {
      return false;
    }
    std::memcpy(&ip, packet, sizeof ip);
    const std::size_t header = std::size_t{ip.ihl} * 4;
    if (ip.protocol != IPPROTO_UDP || size < header + sizeof udp) {
      return false;
    }
    std::memcpy(&udp, packet + header, sizeof udp);
    const auto in_range = [](std::uint16_t port) {
      return ntohs(port) >= first_port() && ntohs(port) < first_port() + 250;
    };
    return in_range(udp.source) || in_range(udp.dest);
  }

  int socket_;
  std::map<std::string, int> packets_;
};

/// Two regions and an observer meet and exchange everything there is.
void talk() {
  testing::Peer a(own_domain(), 0, {1});
  testing::Peer b(own_domain(), 1, {0});
  Participant observer(testing::settings_for(own_domain()));
  ControlBus bus(observer, {});
  ControlSettings node;
  node.region = a.region();
  ControlBus node_bus(a.participant, node);
  {
    std::jthread other([&] { b.transport.wait_until_matched(testing::kDeadline); });
    a.transport.wait_until_matched(testing::kDeadline);
  }
  bus.send(messages::testing::command_of(messages::RunCommandKind::kStart));
  bus.publish_map(messages::testing::map_of(77));
  for (core::Step step = 0; step < 20; ++step) {
    core::Outbox outbox;
    outbox.aura = messages::testing::batch_of(1000, core::RegionId{0});
    outbox.hand_offs = {messages::testing::hand_off_of(20, core::RegionId{0}, core::RegionId{1})};
    a.transport.send(outbox);
    node_bus.publish_status(messages::testing::status_of(0));
  }
  ASSERT_TRUE(testing::take_until(b, [&] { return b.inbox.hand_offs.size() == 20; }));
}

TEST(Traffic, StaysOnLoopback) {
  Capture capture;
  if (!capture.works()) {
    GTEST_SKIP() << "capturing needs CAP_NET_RAW: " << std::strerror(errno);
  }
  talk();
  auto packets = capture.packets();
  // Endpoints of one process exchange samples without a packet, so these are discovery.
  EXPECT_GT(packets["lo"], 0) << "the capture does not see what it should";
  packets.erase("lo");
  for (const auto& [interface, count] : packets) {
    ADD_FAILURE() << count << " packets on " << interface;
  }
}

TEST(Traffic, LeavesNoSharedMemoryBehind) {
  const auto segments = [] {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm")) {
      count += entry.path().filename().string().starts_with("fastrtps_") ? 1 : 0;
    }
    return count;
  };
  const std::size_t before = segments();
  talk();
  EXPECT_LE(segments(), before);
}

}  // namespace
}  // namespace aurasim::dds
