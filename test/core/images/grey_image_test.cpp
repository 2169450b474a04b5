// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/grey_image.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sextant {
namespace {

TEST(GreyImage, SharesGreyAndConvertsColour) {
  const cv::Mat grey(4, 5, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(greyImage(grey).data, grey.data);
  // ITU-R BT.601: 0.114 B + 0.587 G + 0.299 R.
  EXPECT_EQ(greyImage(cv::Mat(4, 5, CV_8UC3, cv::Scalar(10, 100, 200))).at<uchar>(2, 2), 120);
  EXPECT_EQ(greyImage(cv::Mat(4, 5, CV_8UC4, cv::Scalar(10, 100, 200, 9))).at<uchar>(2, 2), 120);
  EXPECT_THROW(greyImage(cv::Mat(4, 5, CV_16UC1)), std::invalid_argument);
}

}  // namespace
}  // namespace sextant
