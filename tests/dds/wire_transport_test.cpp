// The transport alone, without a participant: its datagrams are caught by a plain socket on loopback.
#include "dds/wire_transport.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <arpa/inet.h>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace aurasim::dds {
namespace {

using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kDeadline = 20s;

/// Catches numbered datagrams.
class Catcher {
 public:
  Catcher() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const int bytes = 4 << 20;
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    if (bind(socket_, reinterpret_cast<sockaddr*>(&address), length) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
      throw std::runtime_error("no socket on loopback");
    }
    port_ = ntohs(address.sin_port);
  }
  ~Catcher() { close(socket_); }
  Catcher(const Catcher&) = delete;
  Catcher& operator=(const Catcher&) = delete;

  std::uint16_t port() const { return port_; }

  /// The next one's number; -1 if none comes within `time_out`.
  int next(std::chrono::milliseconds time_out = kDeadline) {
    pollfd wanted{socket_, POLLIN, 0};
    int number = -1;
    if (poll(&wanted, 1, static_cast<int>(time_out.count())) == 1) recv(socket_, &number, sizeof number, 0);
    return number;
  }
  /// Numbers in the order of arrival, until `count` are there or nothing comes for the deadline.
  std::vector<int> catch_all(std::size_t count) {
    std::vector<int> numbers;
    while (numbers.size() < count) {
      const int number = next();
      if (number < 0) break;
      numbers.push_back(number);
    }
    return numbers;
  }

 private:
  int socket_;
  std::uint16_t port_ = 0;
};

class Sender {
 public:
  Sender(const Impairment& impairment, std::uint16_t port, MetatrafficPorts ports = {})
      : line_(std::make_shared<DelayLine>(impairment, 1, std::move(ports))) {
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    const WireTransportDescriptor descriptor(udp, {std::make_shared<rtps::DatagramGuard>(), line_});
    transport_.reset(descriptor.create_transport());
    destination_.kind = LOCATOR_KIND_UDPv4;
    destination_.port = port;
    IPLocator::setIPv4(destination_, "127.0.0.1");
    if (!transport_->init() || !transport_->OpenOutputChannel(sockets_, destination_)) {
      throw std::runtime_error("no transport");
    }
  }

  bool send(int number) {
    eprosima::fastrtps::rtps::LocatorList_t list;
    list.push_back(destination_);
    eprosima::fastdds::rtps::Locators begin(list.begin()), end(list.end());
    eprosima::fastrtps::rtps::octet bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    return sockets_.at(0)->send(bytes, sizeof bytes, &begin, &end, Clock::now() + 1s);
  }
  void send_all(int count) {
    for (int i = 0; i < count; ++i) EXPECT_TRUE(send(i));
  }
  void shutdown() { transport_->shutdown(); }
  ImpairmentCounters counters() const { return line_->counters(); }

 private:
  std::shared_ptr<DelayLine> line_;
  std::unique_ptr<eprosima::fastdds::rtps::TransportInterface> transport_;
  eprosima::fastdds::rtps::SendResourceList sockets_;
  Locator_t destination_;
};

TEST(ImpairedWire, HoldsDatagramsBackForTheDelay) {
  Catcher catcher;
  Sender sender({.delay_s = 0.03}, catcher.port());
  const auto begin = Clock::now();
  sender.send(7);
  EXPECT_EQ(catcher.next(), 7);
  EXPECT_GE(Clock::now() - begin, 30ms);
  EXPECT_EQ(sender.counters().delayed, 1U);
  EXPECT_EQ(sender.counters().queued, 0U);
}

TEST(ImpairedWire, KeepsTheOrderUnlessToldOtherwise) {
  for (const bool reorder : {false, true}) {
    Catcher catcher;
    Sender sender({.delay_s = 0.02, .jitter_s = 0.02, .reorder = reorder}, catcher.port());
    sender.send_all(500);
    const std::vector<int> caught = catcher.catch_all(500);
    EXPECT_EQ(caught.size(), 500U);
    EXPECT_EQ(std::ranges::is_sorted(caught), !reorder);
  }
}

TEST(ImpairedWire, DropsNoMoreThanItSays) {
  Catcher catcher;
  Sender sender({.delay_s = 0.001, .loss = 0.3}, catcher.port());
  sender.send_all(1000);
  const ImpairmentCounters counters = sender.counters();
  EXPECT_NEAR(static_cast<double>(counters.lost), 300, 100);
  EXPECT_EQ(counters.lost + counters.delayed, 1000U);
  EXPECT_EQ(catcher.catch_all(counters.delayed).size(), counters.delayed);
  EXPECT_EQ(catcher.next(50ms), -1);
}

TEST(ImpairedWire, SparesDiscoveryUnlessToldOtherwise) {
  for (const bool discovery : {false, true}) {
    Catcher catcher;
    Sender sender({.loss = 1, .discovery = discovery}, catcher.port(), {.servers = {catcher.port()}});
    sender.send_all(10);
    EXPECT_EQ(sender.counters().passed, discovery ? 0U : 10U);
    EXPECT_EQ(sender.counters().lost, discovery ? 10U : 0U);
    EXPECT_EQ(catcher.next(discovery ? 50ms : 1000ms), discovery ? -1 : 0);
  }
}

TEST(ImpairedWire, SendsWhatWaitsWhenItIsShutDown) {
  Catcher catcher;
  Sender sender({.delay_s = 10}, catcher.port());
  sender.send_all(100);
  EXPECT_EQ(sender.counters().queued, 100U);
  sender.shutdown();
  EXPECT_EQ(sender.counters().queued, 0U);
  const std::vector<int> caught = catcher.catch_all(100);
  EXPECT_EQ(caught.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(caught));
  sender.send(100);  // and later ones at once
  EXPECT_EQ(catcher.next(), 100);
}

}  // namespace
}  // namespace aurasim::dds
