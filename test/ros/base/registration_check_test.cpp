// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/registration_check.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace sextant {
namespace {

/// The answer of a master: one topic with these publishers, no subscribers, one service of /service_node.
XmlRpc::XmlRpcValue stateWith(std::initializer_list<const char*> publishers) {
  XmlRpc::XmlRpcValue state;
  state[0][0][0] = "/topic";
  state[0][0][1].setSize(0);
  int count = 0;
  for (const char* each : publishers) state[0][0][1][count++] = each;
  state[1].setSize(0);
  state[2][0][0] = "/service";
  state[2][0][1][0] = "/service_node";
  return state;
}

TEST(RegistrationCheck, ANodeIsForgottenOnlyBesideAKeeper) {
  EXPECT_FALSE(isForgotten(stateWith({"/other"}), "/node"));
  EXPECT_TRUE(isForgotten(stateWith({"/other", "/registration_keeper"}), "/node"));
  EXPECT_TRUE(isForgotten(stateWith({"/robot/registration_keeper_host_1_2"}), "/node"));
  EXPECT_FALSE(isForgotten(stateWith({"/my_registration_keeper"}), "/node"));
}

TEST(RegistrationCheck, ATopicOrAServiceIsARegistration) {
  EXPECT_FALSE(isForgotten(stateWith({"/registration_keeper", "/node"}), "/node"));
  EXPECT_FALSE(isForgotten(stateWith({"/registration_keeper"}), "/service_node"));
}

}  // namespace
}  // namespace sextant
