// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "sextant/markers/marker_map.hpp"

namespace sextant {

inline void expectSameMap(const MarkerMap& a, const MarkerMap& b) {
  EXPECT_EQ(a.frame(), b.frame());
  ASSERT_EQ(a.markers().size(), b.markers().size());
  for (const auto& [key, marker] : a.markers()) {
    const MappedMarker* other = b.find(key);
    ASSERT_TRUE(other);
    EXPECT_EQ(marker.name, other->name);
    EXPECT_EQ(marker.size, other->size);
    EXPECT_EQ(marker.covariance, other->covariance);
    EXPECT_TRUE(marker.T_map_marker.isApprox(other->T_map_marker, 1e-14));
  }
  ASSERT_EQ(a.frames().size(), b.frames().size());
  for (size_t i = 0; i < a.frames().size(); ++i) EXPECT_EQ(a.frames()[i].parent, b.frames()[i].parent);
}

/// A reading error that begins with "map:line: ".
inline void expectMistake(const std::string& error, int line, const std::string& part) {
  EXPECT_EQ(error.find("map:" + std::to_string(line) + ": "), 0u) << error;
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

}  // namespace sextant
