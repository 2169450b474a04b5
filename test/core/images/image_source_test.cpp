// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/image_source.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>
#include <vector>

namespace sextant {
namespace {

namespace fs = std::filesystem;

cv::Mat noise(int seed, int type = CV_8UC3) {
  cv::Mat picture(48, 64, type);
  cv::RNG(seed).fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

class Source : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/sextant_image_source_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write(const std::string& name, const cv::Mat& picture) const {
    EXPECT_TRUE(cv::imwrite(path(name), picture));
    return path(name);
  }

  std::string writeText(const std::string& name) const {
    std::ofstream(path(name)) << "this is no picture";
    return path(name);
  }

  // The error message if nothing can be played.
  static std::string refusal(ImageSourceParams params) {
    try {
      makeImageSource(params);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "not refused";
  }

  fs::path folder_;
};

ImageSourceParams of(const std::string& source, const std::string& encoding = "bgr8") {
  ImageSourceParams params;
  params.source = source;
  params.encoding = encoding;
  return params;
}

std::vector<cv::Mat> playAll(ImageSource& source) {
  std::vector<cv::Mat> pictures;
  while (source.grab()) pictures.push_back(source.retrieve().clone());
  return pictures;
}

::testing::AssertionResult same(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return ::testing::AssertionFailure() << "size or type";
  if (cv::norm(a, b, cv::NORM_INF) > 0) return ::testing::AssertionFailure() << "grey levels";
  return ::testing::AssertionSuccess();
}

TEST_F(Source, AFolderIsPlayedInTheOrderOfNamesTwice) {
  write("b.png", noise(2));
  write("a.PNG", noise(1));
  writeText("notes.txt");
  const auto source = makeImageSource(of(folder_.string()));
  for (int round = 0; round < 2; ++round, source->open()) {
    const auto pictures = playAll(*source);
    ASSERT_EQ(pictures.size(), 2u);
    EXPECT_TRUE(same(pictures[0], noise(1)));
    EXPECT_TRUE(same(pictures[1], noise(2)));
  }
}

TEST_F(Source, GreyAndColouredImagesComeAsTheEncodingSays) {
  const cv::Mat grey = noise(1, CV_8UC1);
  const std::string file = write("grey.png", grey);
  auto source = makeImageSource(of(file, "mono8"));
  ASSERT_TRUE(source->grab());
  EXPECT_TRUE(same(source->retrieve(), grey));
  EXPECT_FALSE(source->grab());
  source = makeImageSource(of(file, "bgr8"));
  ASSERT_TRUE(source->grab());
  cv::Mat three;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, three);
  EXPECT_TRUE(same(source->retrieve(), three));
}

TEST_F(Source, AVideoGivesWhatItsFramesHeldAtItsRateAndAgainWhenOpenedAgain) {
  const std::string file = path("video.avi");
  {
    cv::VideoWriter writer(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25.0, {64, 48});
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 5; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * i)));
  }
  const auto source = makeImageSource(of(file, "mono8"));
  EXPECT_EQ(source->recordedRate(), 25.0);
  for (int round = 0; round < 2; ++round, source->open()) {
    const auto pictures = playAll(*source);
    ASSERT_EQ(pictures.size(), 5u);
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(cv::mean(pictures[i])[0], 40.0 * i, 3.0);
  }
}

TEST_F(Source, PreloadedPicturesOutliveTheirFiles) {
  write("1.png", noise(1));
  writeText("2.png");
  write("3.png", noise(3));
  ImageSourceParams params = of(folder_.string());
  params.preload = true;
  const auto source = makeImageSource(params);
  fs::remove_all(folder_);
  for (int round = 0; round < 2; ++round, source->open()) {
    ASSERT_TRUE(source->grab());
    EXPECT_TRUE(same(source->retrieve(), noise(1)));
    ASSERT_TRUE(source->grab());
    EXPECT_THROW(source->retrieve(), std::runtime_error);
    ASSERT_TRUE(source->grab());
    EXPECT_TRUE(same(source->retrieve(), noise(3)));
    EXPECT_FALSE(source->grab());
  }
}

TEST_F(Source, WhatCannotBePlayedIsNamed) {
  EXPECT_EQ(refusal(of(path("none.png"))), path("none.png") +
                                               " does not exist: source must be a device, a video file, an "
                                               "image or a folder");
  EXPECT_EQ(refusal(of(folder_.string())), "no image (png, jpg, ...) in the folder " + folder_.string());
  const std::string image = writeText("broken.png");
  EXPECT_EQ(refusal(of(image)), "nothing to play: " + image + ": the image cannot be decoded");
  EXPECT_EQ(refusal(of(folder_.string())), "nothing to play: " + image + ": the image cannot be decoded");
  const std::string video = writeText("broken.avi");
  EXPECT_EQ(refusal(of(video)), video + " is neither a video nor an image that OpenCV can read");
  ImageSourceParams larger = of(write("small.png", noise(1)));
  larger.width = 1280;
  larger.height = 720;
  EXPECT_EQ(refusal(larger), larger.source +
                                 " has 64 x 48 pixels, not the width and height of 1280 x 720; leave them 0 "
                                 "for a file");
}

TEST_F(Source, OnlyADeviceHasControls) {
  ImageSourceParams params = of(write("image.png", noise(1)));
  params.controls.gain = 2.0;
  EXPECT_EQ(refusal(params),
            "exposure, gain, focus, white_balance and automatic are for devices; the source " +
                params.source + " is a file");
  params.source = "/dev/video987";
  EXPECT_EQ(refusal(params), "not refused");
  params.controls.automatic = {"focus"};
  EXPECT_EQ(refusal(params), "not refused");
  params.controls.focus = 10.0;
  EXPECT_EQ(refusal(params), "focus is 10, so it must not be in automatic");
}

TEST_F(Source, ADeviceMayBeMissingUntilItIsOpened) {
  for (const char* name : {"/dev/video987", "987"}) {
    const auto source = makeImageSource(of(name));
    EXPECT_TRUE(source->isLive());
    try {
      source->open();
      ADD_FAILURE() << "opened " << name;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "/dev/video987: No such file or directory; is the camera plugged in?");
    }
  }
}

TEST(ImageSourceParams, OutOfRangeIsRefusedByName) {
  const auto refused = [](auto change) {
    ImageSourceParams params;
    change(params);
    try {
      validate(params);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](auto&) {}), "");
  EXPECT_NE(refused([](auto& p) { p.source = ""; }).find("source"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.encoding = "rgb8"; }).find("mono8, bgr8"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.width = -1; }).find("width"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.height = 20000; }).find("height"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.rate = NAN; }).find("rate"), std::string::npos);
  EXPECT_NE(refused([](auto& p) { p.fourcc = "MJPEG"; }).find("fourcc"), std::string::npos);
}

}  // namespace
}  // namespace sextant
