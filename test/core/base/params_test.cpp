// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/params.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sextant {
namespace {

struct Inner {
  double low = 1.0, high = 2.0;

  ParamList fields() {
    return {{"low", &low, Range::closed(0, 10), "m", "the lower"},
            {"high", &high, Range::closed(low, 10), "m", "the higher"}};
  }
};

struct Outer {
  Inner inner;
  std::string mode = "fast";
  std::map<int, double> sizes;
  std::vector<std::string> cameras = {"markers", "/front/markers", "~own"};
  double position[3] = {0, 0, 0};

  ParamList fields() {
    return joined({prefixed("inner_", inner.fields()),
                   {{"mode", &mode, oneOf({"fast", "exact"}), "", "how"},
                    {"sizes", &sizes, Range::openLow(0, 1), "m", "edges"},
                    {"cameras", &cameras, topics(), "", "which"},
                    {"position", Numbers{position, 3}, Range::closed(-1, 1), "m", "where"}}});
  }
};

std::string refusalOf(const std::function<void(Outer&)>& change) {
  Outer params;
  change(params);
  try {
    validate(params);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Params, AllowedValuesAreAccepted) {
  EXPECT_EQ(refusalOf([](Outer&) {}), "accepted");
}

TEST(Params, WhatIsRefusedIsNamed) {
  EXPECT_EQ(refusalOf([](Outer& p) { p.inner.low = 11; }), "inner_low is 11, allowed is [0, 10] m");
  EXPECT_EQ(refusalOf([](Outer& p) { p.inner.low = 3; }), "inner_high is 2, allowed is [3, 10] m");
  EXPECT_EQ(refusalOf([](Outer& p) { p.mode = "slow"; }), "mode is 'slow', allowed is one of fast, exact");
  EXPECT_EQ(refusalOf([](Outer& p) {
              p.sizes = {{3, 0.5}, {7, 2.0}};
            }),
            "sizes[7] is 2, allowed is (0, 1] m");
  EXPECT_EQ(refusalOf([](Outer& p) { p.position[2] = 2; }), "position is 2, allowed is [-1, 1] m");
}

TEST(Params, TopicsHaveNamesOfTheirOwn) {
  for (const std::string wrong : {"", "front markers", "7up", "a-b"})
    EXPECT_EQ(refusalOf([&](Outer& p) {
                p.cameras = {wrong};
              }).find("cameras: '" + wrong + "' is not a topic name"),
              0u);
  EXPECT_EQ(refusalOf([](Outer& p) { p.cameras = {"a", "a"}; }), "cameras: 'a' is listed twice");
}

TEST(Params, DescribeThemselves) {
  Outer params;
  const ParamList fields = params.fields();
  ASSERT_EQ(fields.size(), 6u);
  EXPECT_EQ(fields[0].name, "inner_low");
  EXPECT_EQ(fields[0].allowed.text, "[0, 10]");
  EXPECT_EQ(typeName(fields[0].value), "double");
  EXPECT_EQ(fields[2].allowed.text, "fast, exact");
  EXPECT_EQ(typeName(fields[2].value), "string");
  EXPECT_EQ(typeName(fields[3].value), "dictionary of doubles");
  EXPECT_EQ(typeName(fields[4].value), "list of strings");
  EXPECT_EQ(typeName(fields[5].value), "list of doubles");
}

}  // namespace
}  // namespace sextant
