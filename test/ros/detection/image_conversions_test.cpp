// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/detection/image_conversions.hpp"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

namespace sextant {
namespace {

namespace encodings = sensor_msgs::image_encodings;

sensor_msgs::ImagePtr imageMsg(const cv::Mat& pixels, const std::string& encoding) {
  auto msg = boost::make_shared<sensor_msgs::Image>();
  msg->width = static_cast<uint32_t>(pixels.cols);
  msg->height = static_cast<uint32_t>(pixels.rows);
  msg->encoding = encoding;
  msg->step = static_cast<uint32_t>(pixels.step);
  msg->data.assign(pixels.datastart, pixels.dataend);
  return msg;
}

cv::Mat gradient() {
  cv::Mat grey(24, 32, CV_8UC1);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) grey.at<uint8_t>(y, x) = static_cast<uint8_t>(4 * x + 5 * y);
  return grey;
}

double difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(ImageBridge, GreyIsTheMessagesOwnMemory) {
  for (const auto& encoding : {encodings::MONO8, encodings::TYPE_8UC1}) {
    const auto msg = imageMsg(gradient(), encoding);
    EXPECT_EQ(greyFromMsg(msg).data, msg->data.data());
    EXPECT_EQ(difference(greyFromMsg(msg), gradient()), 0);
  }
}

TEST(ImageBridge, ColoursAreWeighedAsRec601) {
  // 0.299 R + 0.587 G + 0.114 B of (200, 100, 50)
  const cv::Mat bgr(4, 4, CV_8UC3, cv::Scalar(50, 100, 200)), rgb(4, 4, CV_8UC3, cv::Scalar(200, 100, 50));
  const double grey = 0.299 * 200 + 0.587 * 100 + 0.114 * 50;
  EXPECT_NEAR(greyFromMsg(imageMsg(bgr, encodings::BGR8)).at<uint8_t>(1, 2), grey, 1);
  EXPECT_NEAR(greyFromMsg(imageMsg(bgr, encodings::TYPE_8UC3)).at<uint8_t>(1, 2), grey, 1);
  EXPECT_NEAR(greyFromMsg(imageMsg(rgb, encodings::RGB8)).at<uint8_t>(1, 2), grey, 1);
}

TEST(ImageBridge, SixteenBitsOfEitherByteOrder) {
  cv::Mat little;
  gradient().convertTo(little, CV_16UC1, 257);
  cv::Mat big = little.clone();
  for (auto p = big.begin<uint16_t>(); p != big.end<uint16_t>(); ++p)
    *p = static_cast<uint16_t>(*p << 8 | *p >> 8);
  EXPECT_EQ(difference(greyFromMsg(imageMsg(little, encodings::MONO16)), gradient()), 0);
  const auto msg = imageMsg(big, encodings::MONO16);
  msg->is_bigendian = 1;
  EXPECT_EQ(difference(greyFromMsg(msg), gradient()), 0);
}

TEST(ImageBridge, LuminanceOfYuv422) {
  cv::Mat uyvy;
  cv::merge(std::vector<cv::Mat>{cv::Mat(24, 32, CV_8UC1, cv::Scalar(128)), gradient()}, uyvy);
  EXPECT_EQ(difference(greyFromMsg(imageMsg(uyvy, encodings::YUV422)), gradient()), 0);
}

TEST(ImageBridge, CompressedPicturesComeBack) {
  cv::Mat bgr;
  cv::cvtColor(gradient(), bgr, cv::COLOR_GRAY2BGR);
  std_msgs::Header header;
  header.frame_id = "camera";
  const auto msg = toJpegMsg(bgr, header, 95);
  EXPECT_EQ(msg->header.frame_id, "camera");
  EXPECT_LT(difference(greyFromMsg(*msg), gradient()), 8);
  EXPECT_THROW(greyFromMsg(sensor_msgs::CompressedImage()), std::invalid_argument);
}

// The result is a grey image with the size of the message, or an exception with the reason.
void expectPictureOrReason(const sensor_msgs::ImagePtr& msg) {
  try {
    const cv::Mat grey = greyFromMsg(msg);
    ASSERT_EQ(grey.type(), CV_8UC1) << msg->encoding;
    ASSERT_EQ(grey.cols, static_cast<int>(msg->width)) << msg->encoding;
    ASSERT_EQ(grey.rows, static_cast<int>(msg->height)) << msg->encoding;
    cv::sum(grey);  // reads every pixel
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()), "");
  }
}

// Encodings with and without support by cv_bridge; in one text, because clang-format would use a line for
// each.
std::vector<std::string> encodingNames() {
  std::istringstream in(
      "mono8 mono16 bgr8 rgb8 bgra8 rgba8 bgr16 rgb16 bgra16 rgba16 8UC1 8UC2 8UC3 8UC4 8SC1 16UC1 16SC1 "
      "32SC1 32FC1 64FC1 8UC17 bayer_rggb8 bayer_bggr8 bayer_gbrg8 bayer_grbg16 bayer_rggb16 yuv422 "
      "yuv422_yuy2 nv21 nv24 mono 8UC");
  std::vector<std::string> names = {""};
  for (std::string name; in >> name;) names.push_back(name);
  return names;
}

TEST(ImageBridge, WhateverTheHeaderSays) {
  const auto names = encodingNames();
  std::mt19937 random(3);
  const auto below = [&](uint32_t limit) { return random() % limit; };
  for (int i = 0; i < 20000; ++i) {
    auto msg = boost::make_shared<sensor_msgs::Image>();
    msg->encoding = names[below(static_cast<uint32_t>(names.size()))];
    msg->width = below(10);
    msg->height = below(10);
    msg->step = below(2) ? below(100) : msg->width * (1 + below(8));
    msg->is_bigendian = static_cast<uint8_t>(below(2));
    msg->data.resize(below(2) ? below(1000) : msg->step * msg->height);
    expectPictureOrReason(msg);
  }
}

TEST(ImageBridge, WhateverTheCompressedDataIs) {
  std::mt19937 random(4);
  std::vector<uint8_t> good;
  cv::imencode(".png", gradient(), good);
  for (int i = 0; i < 500; ++i) {
    sensor_msgs::CompressedImage msg;
    msg.data = good;
    msg.data.resize(random() % good.size());
    for (int k = 0; k < 3 && !msg.data.empty(); ++k)
      msg.data[random() % msg.data.size()] = static_cast<uint8_t>(random());
    try {
      EXPECT_EQ(greyFromMsg(msg).type(), CV_8UC1);
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace
}  // namespace sextant
