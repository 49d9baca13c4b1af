// The QoS files, and what settings replace in them.
#include "dds/profiles.h"

#include <fstream>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dds/domain.h"
#include "dds/link_mtu.h"
#include "dds/participant_qos.h"
#include "scratch_folder.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using eprosima::fastdds::dds::DataReaderQos;
using eprosima::fastdds::dds::DataWriterQos;
using eprosima::fastdds::dds::DomainParticipantQos;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::settings_for;
using namespace std::chrono_literals;

DomainParticipantQos qos_for(const Settings& settings) {
  Profiles profiles(settings.profiles);
  return participant_qos(profiles, settings);
}

/// The white list of the only transport; fails when there is any other way out.
std::vector<std::string> white_list(const DomainParticipantQos& qos) {
  EXPECT_FALSE(qos.transport().use_builtin_transports);
  EXPECT_EQ(qos.transport().user_transports.size(), 1U);
  const auto udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(qos.transport().user_transports.at(0));
  return udp == nullptr ? std::vector<std::string>{"not UDP"} : udp->interfaceWhiteList;
}

std::string error_of(const Settings& settings) {
  try {
    qos_for(settings);
  } catch (const DdsError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Interfaces, AreLoopbackAloneByDefault) {
  EXPECT_THAT(white_list(qos_for(settings_for(0))), ElementsAre("127.0.0.1"));
}

/// Nothing can be cut there; elsewhere whoever is silent may be cut off.
TEST(Interfaces, OfWhichAllAreLoopbackKeepTheRunOnThisHost) {
  EXPECT_TRUE(on_loopback_only(qos_for(settings_for(0))));
  EXPECT_FALSE(on_loopback_only(qos_for(settings_for(0, "hosts.xml"))));
  Settings settings = settings_for(0, "hosts.xml");
  settings.interfaces = {"127.0.0.1"};
  EXPECT_TRUE(on_loopback_only(qos_for(settings)));
  settings.interfaces = {"127.0.0.1", "10.1.2.3"};
  EXPECT_FALSE(on_loopback_only(qos_for(settings)));
  settings.interfaces = {"*"};
  EXPECT_FALSE(on_loopback_only(qos_for(settings)));
}

TEST(Interfaces, OfTheSettingsReplaceThoseOfTheFile) {
  for (const char* file : {"aurasim.xml", "hosts.xml", "peers.xml", "slow_link.xml"}) {
    Settings settings = settings_for(0, file);
    settings.interfaces = {"10.1.2.3", "127.0.0.1"};
    EXPECT_THAT(white_list(qos_for(settings)), ElementsAre("10.1.2.3", "127.0.0.1")) << file;
  }
}

TEST(Interfaces, OfTheSettingsDoNotChangeTheNextParticipant) {
  Settings settings = settings_for(0);
  settings.interfaces = {"10.1.2.3"};
  qos_for(settings);
  EXPECT_THAT(white_list(qos_for(settings_for(0))), ElementsAre("127.0.0.1"));
}

TEST(Interfaces, AreAllOnlyWhenSaidSo) {
  Settings settings = settings_for(0);
  settings.interfaces = {"*"};
  EXPECT_THAT(white_list(qos_for(settings)), IsEmpty());
  EXPECT_THAT(white_list(qos_for(settings_for(0, "hosts.xml"))), IsEmpty());
}

/// A datagram that IP has to cut is lost with any of its pieces.
TEST(Messages, FitIntoAPacketOfEveryLinkThatCarriesThem) {
  const std::vector<Interface> host = {{"lo", "127.0.0.1", true, 65536},
                                       {"eth0", "10.1.2.3", false, 1500},
                                       {"eth1", "10.1.3.3", false, 9000},
                                       {"tun0", "10.9.9.9", false, 1280}};
  EXPECT_EQ(largest_payload_B(host, {"127.0.0.1"}), 0U) << "no limit";
  EXPECT_EQ(largest_payload_B(host, {"10.1.2.3"}), 1472U);
  EXPECT_EQ(largest_payload_B(host, {"10.1.3.3"}), 8972U);
  EXPECT_EQ(largest_payload_B(host, {"10.1.2.3", "127.0.0.1", "10.1.3.3"}), 1472U);
  EXPECT_EQ(largest_payload_B(host, {}), 1252U) << "no white list: all of them";
  EXPECT_EQ(largest_payload_B(host, {"10.1.9.9"}), 0U) << "an address that is not here";
}

TEST(Messages, AreCutOnlyWhereALinkNeedsIt) {
  const auto largest_message = [](const Settings& settings) {
    const auto qos = qos_for(settings);
    return std::dynamic_pointer_cast<UDPv4TransportDescriptor>(qos.transport().user_transports.at(0))->maxMessageSize;
  };
  Settings settings = settings_for(0);
  EXPECT_GT(largest_message(settings), 60'000U) << "loopback";
  for (const Interface& link : interfaces_of_this_host()) {
    settings.interfaces = {link.address};
    if (!link.is_loopback) {
      EXPECT_LE(largest_message(settings), link.mtu_B - 28) << link.name;
    }
  }
  EXPECT_GT(largest_message(settings_for(0)), 60'000U) << "the profile itself stays";
}

TEST(Peers, ReplaceMulticastAndThePeersOfTheFile) {
  Settings settings = settings_for(0);
  settings.discovery = config::Discovery::kPeers;
  settings.interfaces = {"127.0.0.1"};
  settings.peers = {"127.0.0.1", "127.0.0.1:7410"};
  const DomainParticipantQos qos = qos_for(settings);
  const auto& builtin = qos.wire_protocol().builtin;
  EXPECT_EQ(builtin.initialPeersList.size(), 2U);
  EXPECT_EQ(builtin.metatrafficUnicastLocatorList.size(), 1U);
}

TEST(Peers, ThatCannotBeUsedAreNamed) {
  Settings settings = settings_for(0);
  settings.discovery = config::Discovery::kPeers;
  EXPECT_THAT(error_of(settings), HasSubstr("neither dds.peers nor the profile names a peer"));
  settings.peers = {"127.0.0.1:"};
  EXPECT_THAT(error_of(settings), HasSubstr("'127.0.0.1:' is not"));
  settings.peers = {"127.0.0.1:99999"};
  EXPECT_THAT(error_of(settings), HasSubstr("'127.0.0.1:99999' is not"));
  settings.peers = {"lathe.example"};
  EXPECT_THAT(error_of(settings), HasSubstr("'lathe.example' is not an IPv4 address"));
  settings.peers = {"127.0.0.1"};
  EXPECT_THAT(error_of(settings), HasSubstr("no own address is known"));
}

TEST(Servers, AreClientsOfTheListedOnes) {
  Settings settings = settings_for(0);
  settings.discovery = config::Discovery::kServer;
  EXPECT_THAT(error_of(settings), HasSubstr("names a server"));
  settings.peers = {"127.0.0.1", "127.0.0.1:11888"};
  const DomainParticipantQos qos = qos_for(settings);
  const auto& discovery = qos.wire_protocol().builtin.discovery_config;
  EXPECT_EQ(discovery.discoveryProtocol, eprosima::fastrtps::rtps::DiscoveryProtocol_t::SUPER_CLIENT);
  EXPECT_EQ(discovery.m_DiscoveryServers.size(), 2U);
}

TEST(PeersFile, LetsTwoRegionsMeetWithoutMulticast) {
  testing::Peer a(settings_for(own_domain(), "peers.xml"), 0, {1});
  testing::Peer b(settings_for(own_domain(), "peers.xml"), 1, {0});
  std::jthread other([&] { b.transport.wait_until_matched(testing::kDeadline); });
  EXPECT_NO_THROW(a.transport.wait_until_matched(testing::kDeadline));
}

/// A process that has joined DDS more often than peers try numbers of participants (32).
TEST(PeersFile, IsFoundHoweverOftenItJoins) {
  for (int i = 0; i < 40; ++i) Participant before(settings_for(own_domain(), "peers.xml"));
  testing::Peer a(settings_for(own_domain(), "peers.xml"), 0, {1});
  testing::Peer b(settings_for(own_domain(), "peers.xml"), 1, {0});
  std::jthread other([&] { b.transport.wait_until_matched(testing::kDeadline); });
  EXPECT_NO_THROW(a.transport.wait_until_matched(testing::kDeadline));
}

TEST(HostsFile, DiffersFromTheDefaultOnlyInItsLeases) {
  Settings loopback = settings_for(own_domain());
  Domain domain(loopback);
  Profiles hosts(settings_for(own_domain(), "hosts.xml").profiles);
  auto* publisher = domain.participant().create_publisher(eprosima::fastdds::dds::PUBLISHER_QOS_DEFAULT);
  auto* subscriber = domain.participant().create_subscriber(eprosima::fastdds::dds::SUBSCRIBER_QOS_DEFAULT);
  for (const std::string topic :
       {"aura", "migration", "node_status", "region_map", "run_control", "replica", "replica_key"}) {
    DataWriterQos writer = hosts.writer(*publisher, topic + "_writer");
    const DataWriterQos default_writer = domain.profiles().writer(*publisher, topic + "_writer");
    DataReaderQos reader = hosts.reader(*subscriber, topic + "_reader");
    const DataReaderQos default_reader = domain.profiles().reader(*subscriber, topic + "_reader");
    const bool longer = topic == "aura" || topic == "node_status";
    EXPECT_EQ(writer.liveliness().lease_duration == default_writer.liveliness().lease_duration, !longer) << topic;
    EXPECT_EQ(reader.liveliness().lease_duration == default_reader.liveliness().lease_duration, !longer) << topic;
    writer.liveliness(default_writer.liveliness());
    reader.liveliness(default_reader.liveliness());
    EXPECT_TRUE(writer == default_writer) << topic;
    EXPECT_TRUE(reader == default_reader) << topic;
  }
}

/// A folder with one profile file of our own.
class OwnFile : public ::testing::Test {
 protected:
  Settings write(const std::string& name, const std::string& profiles) {
    std::ofstream(folder_ / name) << R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>)"
                                  << profiles << "</profiles></dds>\n";
    Settings settings;
    settings.profiles = folder_ / name;
    return settings;
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
};

TEST_F(OwnFile, ThatIsNotThereIsNamed) {
  Settings settings = write("here.xml", "");
  settings.profiles = folder_ / "nowhere.xml";
  EXPECT_THAT(error_of(settings), AllOf(HasSubstr("nowhere.xml"), HasSubstr("cannot read")));
  settings.profiles.clear();
  EXPECT_THAT(error_of(settings), HasSubstr("dds.profiles"));
}

TEST_F(OwnFile, WithAnUnknownElementIsRefusedAsAWhole) {
  const Settings settings = write("odd.xml", R"(<participant profile_name="odd_participant"><rtps>
      <name>x</name><frobnicate>1</frobnicate></rtps></participant>)");
  EXPECT_THAT(error_of(settings), AllOf(HasSubstr("odd.xml"), HasSubstr("Fast DDS refuses")));
}

TEST_F(OwnFile, WithoutTheProfileIsNamedWithTheNamesLookedFor) {
  const Settings settings = write("bare.xml", R"(<data_writer profile_name="bare_x"></data_writer>)");
  Profiles profiles(settings.profiles);
  Domain domain(settings_for(own_domain()));
  auto* publisher = domain.participant().create_publisher(eprosima::fastdds::dds::PUBLISHER_QOS_DEFAULT);
  try {
    profiles.writer(*publisher, "missing_writer");
    FAIL() << "there is no such profile";
  } catch (const DdsError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("bare.xml: no data_writer profile named 'bare_missing_writer'"),
                                    HasSubstr("'missing_writer'")));
  }
}

TEST_F(OwnFile, ChangesARunWithoutARebuild) {
  Settings settings = write("own.xml", R"(<data_writer profile_name="own_aura_writer"><qos>
      <reliability><kind>BEST_EFFORT</kind></reliability></qos></data_writer>)");
  Profiles profiles(settings.profiles);
  Domain domain(settings_for(own_domain()));
  auto* publisher = domain.participant().create_publisher(eprosima::fastdds::dds::PUBLISHER_QOS_DEFAULT);
  EXPECT_EQ(profiles.writer(*publisher, "aura_writer").reliability().kind,
            eprosima::fastdds::dds::BEST_EFFORT_RELIABILITY_QOS);
  EXPECT_EQ(domain.profiles().writer(*publisher, "aura_writer").reliability().kind,
            eprosima::fastdds::dds::RELIABLE_RELIABILITY_QOS);
}

}  // namespace
}  // namespace aurasim::dds
