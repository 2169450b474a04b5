// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "test_descriptors.hpp"

namespace sextant {
namespace {

TEST(FaissIndex, LargeIndexStoresHalfOfTheBytesPerDescriptor) {
  if (!hasFaiss()) GTEST_SKIP() << "built without faiss";
  const cv::Mat all = randomDescriptors(700, 65, CV_32F, 1);
  for (const auto& [expected, bytes] : std::map<int64_t, int>{{700, 64}, {2000000, 32}}) {
    const auto index = makeDescriptorIndex("faiss", all, expected);
    const int64_t before = index->bytes();
    index->add(0, all);
    EXPECT_EQ(index->bytes() - before, 700 * (bytes + 8));  // 8 bytes for the id
    const Neighbours found = index->search(all, 1);
    int right = 0;
    for (int row = 0; row < all.rows; ++row) right += found.rows[row] == row;
    EXPECT_GT(right, 0.95 * all.rows);
  }
}

}  // namespace
}  // namespace sextant
