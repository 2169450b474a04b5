// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/apriltag_family.hpp"

#include <gtest/gtest.h>

#include <bitset>
#include <regex>
#include <stdexcept>

namespace sextant {
namespace {

// The name of a family contains the number of bits of a code and the minimum Hamming distance of two codes.
TEST(AprilTagFamily, IsWhatItsNameTells) {
  for (const std::string& name : aprilTagFamilies()) {
    const AprilTagFamily family = makeAprilTagFamily(name);
    EXPECT_EQ(family->name, name);
    std::smatch parts;
    ASSERT_TRUE(std::regex_match(name, parts, std::regex("tag[A-Za-z]*(\\d+)h(\\d+)")));
    EXPECT_EQ(family->nbits, std::stoul(parts[1]));
    EXPECT_EQ(family->h, std::stoul(parts[2]));
    const uint32_t count = std::min<uint32_t>(family->ncodes, 600);
    for (uint32_t i = 0; i < count; ++i)
      for (uint32_t j = 0; j < i; ++j)
        EXPECT_GE(std::bitset<64>(family->codes[i] ^ family->codes[j]).count(), family->h);
  }
}

TEST(AprilTagFamily, RefusesAnUnknownName) {
  EXPECT_THROW(makeAprilTagFamily("tag37h11"), std::out_of_range);
}

}  // namespace
}  // namespace sextant
