// Anybody can send a datagram to a run's ports.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "system_fixture.h"

namespace aurasim::system_test {
namespace {

using ::testing::HasSubstr;

/// To the ports of a domain's first participants, and to those that all listen to; loopback only.
class Stranger {
 public:
  explicit Stranger(std::uint32_t domain)
      : first_port_(7400 + 250 * domain), socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    ::setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  }
  ~Stranger() { ::close(socket_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  void send_to_all(const std::vector<unsigned char>& bytes) const {
    constexpr std::uint32_t kParticipants = 8;
    send(bytes, "239.255.0.1", first_port_);
    for (std::uint32_t i = 0; i < 2 * kParticipants; ++i) send(bytes, "127.0.0.1", first_port_ + 10 + i);
  }

 private:
  void send(const std::vector<unsigned char>& bytes, const char* address, std::uint32_t port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, address, &to.sin_addr);
    ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

  std::uint32_t first_port_;
  int socket_;
};

/// RTPS, of eProsima, and statistics that are followed by something: Fast DDS 2.9.1 ends itself.
std::vector<unsigned char> the_one_of_92_bytes() {
  std::vector<unsigned char> bytes = {'R', 'T', 'P', 'S', 2, 2,  1,  15, 1,    2, 3,  4,
                                      5,   6,   7,   8,   9, 10, 11, 12, 0x80, 1, 56, 0};
  bytes.resize(92);
  return bytes;
}

class Guard : public SystemTest {};

TEST_F(Guard, ARunGoesOnAfterADatagramThatEndsFastDds) {
  Process& run = launch("run", launch_file("corner_stacks"), {"--steps", "300"});
  ASSERT_NO_FATAL_FAILURE(expect_reaches(report_of("run"), 4, 30));
  const Stranger stranger(test::own_domain());
  for (int i = 0; i < 20; ++i) stranger.send_to_all(the_one_of_92_bytes());
  expect_exit(run, 0);
  expect_all_bodies_accounted_for(report_of("run"));
  EXPECT_THAT(run.err(), HasSubstr("datagrams from 127.0.0.1 are not what a run's peers send"));
  EXPECT_THAT(run.err(), HasSubstr("statistics"));
}

TEST_F(Guard, DropsNothingOfARunWithoutStrangers) {
  Process& run = launch("run", launch_file("corner_stacks"), {"--steps", "120"});
  expect_exit(run, 0);
  EXPECT_THAT(run.err(), ::testing::Not(HasSubstr("datagrams")));
}

}  // namespace
}  // namespace aurasim::system_test
