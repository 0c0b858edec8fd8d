// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include <cstring>

#include "drivers/socketcan/link.hpp"

namespace dampline::drivers {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Message = std::vector<std::byte>;

template <class T>
Message bytes_of(const T& value) {
  Message bytes(sizeof(T));
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

Message bytes_of(const char* text) {
  Message bytes(std::strlen(text) + 1);
  std::memcpy(bytes.data(), text, bytes.size());
  return bytes;
}

Message operator+(Message a, const Message& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Message padded(Message bytes) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

Message attribute(int type, const Message& payload) {
  const rtattr header{static_cast<unsigned short>(sizeof(rtattr) + payload.size()),
                      static_cast<unsigned short>(type)};
  return padded(bytes_of(header) + payload);
}

Message message(const Message& attributes, unsigned flags = IFF_UP,
                unsigned short type = ARPHRD_CAN) {
  ifinfomsg info{};
  info.ifi_type = type;
  info.ifi_index = 4;
  info.ifi_flags = flags;
  const Message body = bytes_of(info) + attributes;
  nlmsghdr header{};
  header.nlmsg_len = static_cast<std::uint32_t>(sizeof(header) + body.size());
  header.nlmsg_type = RTM_NEWLINK;
  return padded(bytes_of(header) + body);
}

/// can0 of a controller: 250 kbit/s, error-passive.
Message controller(std::uint32_t restart_ms, std::uint32_t state = CAN_STATE_ERROR_PASSIVE) {
  can_bittiming timing{};
  timing.bitrate = 250'000;
  const Message data = attribute(IFLA_CAN_BITTIMING, bytes_of(timing)) +
                       attribute(IFLA_CAN_STATE, bytes_of(state)) +
                       attribute(IFLA_CAN_RESTART_MS, bytes_of(restart_ms));
  return message(attribute(IFLA_IFNAME, bytes_of("can0")) +
                 attribute(IFLA_MTU, bytes_of(std::uint32_t{16})) +
                 attribute(IFLA_LINKINFO, attribute(IFLA_INFO_KIND, bytes_of("can")) +
                                              attribute(IFLA_INFO_DATA, data)));
}

Message virtual_bus(unsigned flags) {
  return message(attribute(IFLA_IFNAME, bytes_of("vcan0")) +
                     attribute(IFLA_MTU, bytes_of(std::uint32_t{72})) +
                     attribute(IFLA_LINKINFO, attribute(IFLA_INFO_KIND, bytes_of("vcan"))),
                 flags);
}

TEST(CanLink, ReadsAController) {
  const auto links = parse_links(controller(0));
  ASSERT_EQ(links.size(), 1U);
  const LinkState& link = links[0];
  EXPECT_EQ(link.name, "can0");
  EXPECT_EQ(link.index, 4);
  EXPECT_TRUE(link.up);
  EXPECT_FALSE(link.fd);
  EXPECT_EQ(link.bitrate, 250'000U);
  EXPECT_EQ(link.restart_ms, 0U);
  EXPECT_EQ(link.state, CanState::kErrorPassive);
}

TEST(CanLink, KnowsNoStateThatTheKernelDoesNotName) {
  EXPECT_EQ(parse_links(controller(0, CAN_STATE_MAX - 1)).at(0).state, CanState::kSleeping);
  EXPECT_EQ(parse_links(controller(0, CAN_STATE_MAX)).at(0).state, LinkState{}.state);
}

TEST(CanLink, WarnsWhereBusOffWouldBeForEver) {
  const auto warnings = link_warnings(parse_links(controller(0)).at(0));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], HasSubstr("can0: restart-ms is 0"));
  EXPECT_THAT(link_warnings(parse_links(controller(100)).at(0)), IsEmpty());
}

TEST(CanLink, HasNothingToSayOfAVirtualBusButThatItIsDown) {
  const auto links = parse_links(virtual_bus(IFF_UP) + virtual_bus(0));
  ASSERT_EQ(links.size(), 2U);
  EXPECT_TRUE(links[0].fd);
  EXPECT_FALSE(links[0].restart_ms.has_value());
  EXPECT_THAT(link_warnings(links[0]), IsEmpty());
  ASSERT_EQ(link_warnings(links[1]).size(), 1U);
  EXPECT_THAT(link_warnings(links[1])[0], HasSubstr("vcan0: the interface is down"));
}

TEST(CanLink, LeavesOtherNetworksAlone) {
  EXPECT_THAT(parse_links(message(attribute(IFLA_IFNAME, bytes_of("eth0")), IFF_UP, 1)), IsEmpty());
}

TEST(CanLink, SurvivesEveryTruncationAndEveryByte) {
  const Message whole = controller(100) + virtual_bus(IFF_UP);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Message part{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)};
    EXPECT_LT(parse_links(part).size(), 2U);
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const unsigned value : {0U, 1U, 0x7FU, 0xFFU}) {
      Message changed = whole;
      changed[at] = static_cast<std::byte>(value);
      EXPECT_LE(parse_links(changed).size(), 2U);
    }
  }
}

TEST(CanLink, AsksTheKernelAndNamesAnInterfaceThatIsNotThere) {
  const auto links = read_links();
  ASSERT_TRUE(links.ok()) << links.error_text();
  const bool none = links.value().empty();
  EXPECT_EQ(links_text() == "there is no CAN interface", none) << links_text();
  EXPECT_EQ(links_text().starts_with("CAN interfaces are: "), !none) << links_text();
  const auto link = read_link("can_none");
  ASSERT_FALSE(link.ok());
  EXPECT_THAT(link.error_text(), HasSubstr("can_none: there is no such interface; "));
  EXPECT_THAT(read_link("lo").error_text(), HasSubstr("lo: is not a CAN interface; "));
}

}  // namespace
}  // namespace dampline::drivers
