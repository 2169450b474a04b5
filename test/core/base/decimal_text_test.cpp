// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/decimal_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

namespace sextant {
namespace {

TEST(ShortestDecimal, HasNoDigitTooManyAndNoneTooFew) {
  EXPECT_EQ(shortestDecimal(0.1), "0.1");
  EXPECT_EQ(shortestDecimal(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(shortestDecimal(1.0 / 3), "0.3333333333333333");
  EXPECT_EQ(shortestDecimal(-3), "-3");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> digits(-1, 1), exponent(-300, 300);
  for (int i = 0; i < 1000; ++i) {
    const double value = digits(random) * std::pow(10, exponent(random));
    EXPECT_EQ(std::strtod(shortestDecimal(value).c_str(), nullptr), value);
  }
}

}  // namespace
}  // namespace sextant
