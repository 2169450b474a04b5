// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/aruco_dictionary.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <stdexcept>

namespace sextant {
namespace {

// "DICT_6X6_250": 250 markers of 6 x 6 bits.
TEST(ArucoDictionary, HasTheSizeOfItsName) {
  int count = 0;
  for (const std::string& name : arucoDictionaries()) {
    const auto dictionary = makeArucoDictionary(name);
    std::smatch parts;
    if (!std::regex_match(name, parts, std::regex("DICT_(\\d)X(\\d)_(\\d+)"))) continue;
    EXPECT_EQ(dictionary.markerSize, std::stoi(parts[1]));
    EXPECT_EQ(dictionary.bytesList.rows, std::stoi(parts[3]));
    ++count;
  }
  EXPECT_EQ(count, 16);
  EXPECT_EQ(makeArucoDictionary("DICT_ARUCO_ORIGINAL").bytesList.rows, 1024);
}

TEST(ArucoDictionary, RefusesAnUnknownName) {
  EXPECT_THROW(makeArucoDictionary("DICT_4X4_51"), std::out_of_range);
}

}  // namespace
}  // namespace sextant
