// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "code_reader.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "sextant/markers/aruco_dictionary.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

const std::array<cv::Point2f, 4> kPlace = {
    cv::Point2f{20.3F, 15.2F}, {60.1F, 19.7F}, {56.4F, 61.3F}, {18.8F, 52.6F}};

// A print of DICT_5X5_50 seen there, on white.
cv::Mat seen(int id) {
  cv::Mat large, image;
  cv::resize(markerImage("DICT_5X5_50", id).modules, large, {}, 20, 20, cv::INTER_NEAREST);
  const float end = static_cast<float>(large.cols) - 0.5F;
  const std::array<cv::Point2f, 4> print = {
      cv::Point2f{-0.5F, -0.5F}, {end, -0.5F}, {end, end}, {-0.5F, end}};
  cv::warpPerspective(large, image, cv::getPerspectiveTransform(print.data(), kPlace.data()), {80, 80},
                      cv::INTER_AREA, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::GaussianBlur(image, image, {}, 0.8);
  image.convertTo(image, CV_8UC1, 0.5, 40);
  return image;
}

CodeReader reader() { return {makeArucoDictionary("DICT_5X5_50"), cv::aruco::DetectorParameters()}; }

TEST(CodeReader, ReadsEveryMarkerFromEveryCorner) {
  for (int id = 0; id < 50; ++id)
    for (int turn = 0; turn < 4; ++turn) {
      std::array<cv::Point2f, 4> corners;
      for (int i = 0; i < 4; ++i) corners[i] = kPlace[(i + turn) % 4] + cv::Point2f(0.7F, -0.7F);
      const Code code = reader().read(seen(id), corners);
      EXPECT_EQ(code.id, id);
      EXPECT_EQ(code.rotation, turn);
      EXPECT_EQ(code.dark_border, 1);
    }
}

TEST(CodeReader, ReadsNothingWhereNoMarkerIs) {
  EXPECT_EQ(reader().read(cv::Mat(80, 80, CV_8UC1, cv::Scalar(90)), kPlace).id, -1);
  const Code light = reader().read(255 - seen(3), kPlace);  // as a negative
  EXPECT_EQ(light.id, -1);
  EXPECT_EQ(light.dark_border, 0);
}

}  // namespace
}  // namespace sextant
