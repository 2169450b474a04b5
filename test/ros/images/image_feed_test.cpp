// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/images/image_feed.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <vector>

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kWait{10000};

/// Behaviour of a camera in successive calls of open() or grab(), one letter each: o opens, x does not open,
/// p has an image, b has one that cannot be decoded, - has none. After the last letter there are images
/// forever. When it is opened, it refuses the settings.
class ScriptedSource : public ImageSource {
 public:
  ScriptedSource(std::string script, bool live, std::vector<std::string> refused)
      : script_(std::move(script)), live_(live), refused_(std::move(refused)) {}

  void open() override {
    if (next() != 'o') throw std::runtime_error("does not open");
  }
  bool grab() override {
    std::this_thread::sleep_for(milliseconds(1));
    letter_ = next();
    return letter_ != '-';
  }
  cv::Mat retrieve() override {
    if (letter_ == 'b') throw std::runtime_error("cannot be decoded");
    return cv::Mat(2, 3, CV_8UC1, cv::Scalar(++decoded_));
  }
  std::vector<std::string> refusedSettings() const override { return refused_; }
  bool isLive() const override { return live_; }
  double recordedRate() const override { return live_ ? 0.0 : 50.0; }

 private:
  char next() { return at_ < script_.size() ? script_[at_++] : 'p'; }

  std::string script_;
  bool live_;
  std::vector<std::string> refused_;
  size_t at_ = 0;
  char letter_ = '-';
  int decoded_ = 0;
};

class Feed : public ::testing::Test {
 protected:
  void SetUp() override { ros::Time::init(); }

  void play(const std::string& script, bool live, const ImageFeedParams& params,
            const std::vector<std::string>& refused = {}) {
    feed_ = std::make_unique<ImageFeed>(
        std::make_unique<ScriptedSource>(script, live, refused), params,
        ImageFeed::Outlet{[this] { return subscribed_.load(); }, [this] { return subscribed_.load(); },
                          [this](const cv::Mat& picture, const ros::Time& stamp) {
                            const std::lock_guard<std::mutex> lock(mutex_);
                            values_.push_back(picture.at<uchar>(0, 0));
                            stamps_.push_back(stamp.toSec());
                          }},
        trouble_);
  }

  template <typename Condition>
  static bool waitUntil(Condition condition) {
    const auto end = Clock::now() + kWait;
    while (!condition() && Clock::now() < end) std::this_thread::sleep_for(milliseconds(2));
    return condition();
  }

  bool waitForEnd() {
    return waitUntil([this] { return feed_->counts().finished; });
  }

  std::string summary() const {
    diagnostic_updater::DiagnosticStatusWrapper status;
    trouble_.fill(status);
    std::string text = status.message;
    for (const auto& row : status.values) text += "; " + row.key + "=" + row.value;
    return text;
  }

  std::atomic<bool> subscribed_{true};
  std::mutex mutex_;
  std::vector<int> values_;
  std::vector<double> stamps_;
  TroubleLog trouble_{"test"};
  std::unique_ptr<ImageFeed> feed_;
};

ImageFeedParams frames(int number, double rate = 0.0) {
  ImageFeedParams params;
  params.frames = number;
  params.rate = rate;
  return params;
}

TEST_F(Feed, ALostCameraIsOpenedAgainAndGoesOn) {
  play("opp-xopp", true, frames(4));
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_, (std::vector<int>{1, 2, 3, 4}));
  EXPECT_GT(stamps_[2] - stamps_[1], 1.9);  // a second after the loss, another after it did not open
  EXPECT_EQ(feed_->counts().opened, 2u);
  EXPECT_EQ(summary(), "working; not used: camera lost=1; not used: source=1");
}

TEST_F(Feed, SettingsThatTheCameraRefusesAreReportedWhileImagesAreUsed) {
  play("op", true, frames(1), {"the camera refuses gain of 3", "the camera refuses automatic focus"});
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_.size(), 1u);
  EXPECT_EQ(feed_->refusedSettings(), "the camera refuses gain of 3; the camera refuses automatic focus");
  EXPECT_EQ(summary(), "working; not used: setting=1");
}

TEST_F(Feed, ACameraThatIsNotThereYetIsWaitedFor) {
  play("xo", true, frames(1));
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_.size(), 1u);
}

TEST_F(Feed, APictureThatCannotBeDecodedIsSkippedAndCounted) {
  play("opbbp-", false, frames(0));
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_, (std::vector<int>{1, 2}));
  EXPECT_EQ(summary(), "working; not used: image=2");
}

TEST_F(Feed, AFileEndsOrBeginsAnew) {
  play("opp-", false, frames(0));
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_.size(), 2u);
  ImageFeedParams loop = frames(5);
  loop.loop = true;
  play("opp-opp-opp-", false, loop);
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_.size(), 7u);
  EXPECT_EQ(feed_->counts().opened, 3u);
}

TEST_F(Feed, AFileIsPlayedAtItsOwnRateOrAtTheGivenOne) {
  play("o", false, frames(20));  // recorded at 50 Hz
  ASSERT_TRUE(waitForEnd());
  EXPECT_NEAR(stamps_.back() - stamps_.front(), 19 / 50.0, 0.1);
  stamps_.clear();
  play("o", false, frames(20, 100.0));
  ASSERT_TRUE(waitForEnd());
  EXPECT_NEAR(stamps_.back() - stamps_.front(), 19 / 100.0, 0.1);
}

TEST_F(Feed, ACameraThatIsFasterThanTheRateIsThinned) {
  play("o", true, frames(20, 50.0));  // it gives nearly 1000 pictures a second
  ASSERT_TRUE(waitForEnd());
  EXPECT_NEAR(stamps_.back() - stamps_.front(), 19 / 50.0, 0.1);
  EXPECT_GT(feed_->counts().skipped, 100u);
}

TEST_F(Feed, AFileWaitsForAListenerWhileACameraIsKeptFresh) {
  subscribed_ = false;
  play("o", false, frames(3));
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_EQ(feed_->counts().opened, 0u);
  subscribed_ = true;
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_, (std::vector<int>{1, 2, 3}));

  subscribed_ = false;
  play("o", true, frames(1));
  ASSERT_TRUE(waitUntil([this] { return feed_->counts().skipped > 20; }));
  subscribed_ = true;
  ASSERT_TRUE(waitForEnd());
  EXPECT_EQ(values_.back(), 1);  // the first that was decoded
}

TEST_F(Feed, StopsAtOnceWhileItWaits) {
  play("xxxxxxxxxxxxxxxxxxxx", true, frames(0));
  ASSERT_TRUE(waitUntil([this] { return summary().find("source") != std::string::npos; }));
  const auto begin = Clock::now();
  feed_.reset();
  EXPECT_LT(Clock::now() - begin, milliseconds(500));
}

}  // namespace
}  // namespace sextant
