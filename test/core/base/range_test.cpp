// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/range.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sextant {
namespace {

TEST(Range, HoldsItsBounds) {
  EXPECT_NO_THROW(Range::closed(1, 2).require("x", 1));
  EXPECT_NO_THROW(Range::openLow(1, 2).require("x", 2));
  EXPECT_THROW(Range::openLow(1, 2).require("x", 1), std::invalid_argument);
  EXPECT_THROW(Range::closed(1, 2).require("x", 2.1), std::invalid_argument);
  EXPECT_NO_THROW(Range::openHigh(1, 2).require("x", 1));
  EXPECT_THROW(Range::openHigh(1, 2).require("x", 2), std::invalid_argument);
  EXPECT_THROW(Range::closed(1, 2).require("x", std::nan("")), std::invalid_argument);
}

TEST(Range, SaysWhatIsAllowed) {
  try {
    Range::openLow(0, 10).require("corner_sigma", -1, "px");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "corner_sigma is -1, allowed is (0, 10] px");
  }
  EXPECT_EQ(Range::closed(0.5, 0.9999999).text(), "[0.5, 0.9999999]");
  EXPECT_EQ(Range::openHigh(0.001, 1).text(), "[0.001, 1)");
}

}  // namespace
}  // namespace sextant
