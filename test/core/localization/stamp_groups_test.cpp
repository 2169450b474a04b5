// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/stamp_groups.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sextant {
namespace {

using Groups = StampGroups<std::string>;

// "left0 right1", or "-" if no group is ready.
std::string taken(Groups& groups, double now) {
  const auto group = groups.take(now);
  if (!group) return "-";
  std::string text;
  for (const auto& member : *group) text += member.item + std::to_string(member.camera) + " ";
  return text;
}

TEST(StampGroups, OneCameraWaitsForNobody) {
  Groups groups({1, 0.01, 0.05});
  EXPECT_EQ(taken(groups, 0), "-");
  groups.add(0, 100.0, 0, "a");
  groups.add(0, 100.03, 0, "b");
  EXPECT_EQ(taken(groups, 0), "a0 ");
  EXPECT_EQ(taken(groups, 0), "b0 ");
  EXPECT_TRUE(groups.empty());
}

TEST(StampGroups, NearStampsAreOneGroup) {
  Groups groups({2, 0.01, 0.05});
  groups.add(1, 100.004, 0.0, "r");
  EXPECT_EQ(taken(groups, 0.0), "r1 ");  // the other camera has never published
  groups.add(0, 100.030, 0.03, "l");
  EXPECT_EQ(taken(groups, 0.031), "-");
  groups.add(1, 100.034, 0.033, "r");
  EXPECT_EQ(taken(groups, 0.034), "l0 r1 ");
}

TEST(StampGroups, FarStampsAreGroupsOfTheirOwnTheOldestFirst) {
  Groups groups({2, 0.01, 0.05});
  groups.add(0, 100.050, 0.05, "l");
  groups.add(1, 100.020, 0.06, "r");
  EXPECT_EQ(taken(groups, 0.06), "r1 ");
  EXPECT_EQ(taken(groups, 0.06), "-");
}

TEST(StampGroups, PatienceEnds) {
  Groups groups({2, 0.01, 0.05});
  groups.add(0, 100.0, 0.0, "l");
  groups.add(1, 100.0, 0.0, "r");
  EXPECT_EQ(taken(groups, 0.0), "l0 r1 ");
  groups.add(0, 100.1, 0.1, "l");
  EXPECT_EQ(taken(groups, 0.149), "-");
  EXPECT_EQ(taken(groups, 0.151), "l0 ");
  groups.add(0, 101.2, 1.2, "l");
  EXPECT_EQ(taken(groups, 1.2), "l0 ");  // the right one has published nothing for more than a second
}

TEST(StampGroups, ClearForgets) {
  Groups groups({2, 0.01, 0.05});
  groups.add(0, 100.0, 0.0, "l");
  groups.clear();
  EXPECT_TRUE(groups.empty());
  EXPECT_EQ(taken(groups, 10), "-");
}

}  // namespace
}  // namespace sextant
