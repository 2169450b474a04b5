// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/images/image_feed.hpp"

#include <ros/console.h>

#include <stdexcept>
#include <utility>

namespace sextant {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRetry{1000};
constexpr milliseconds kLook{20};
// A subscriber of the images connects to camera_info a moment later and would miss it for the first images.
constexpr milliseconds kSettle{500};

}  // namespace

ImageFeed::ImageFeed(std::unique_ptr<ImageSource> source, const ImageFeedParams& params, Outlet outlet,
                     TroubleLog& trouble)
    : source_(std::move(source)), params_(params), outlet_(std::move(outlet)), trouble_(trouble) {
  validate(params_);
  thread_ = std::thread(&ImageFeed::run, this);
}

ImageFeed::~ImageFeed() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

ImageFeed::Counts ImageFeed::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

std::string ImageFeed::refusedSettings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return refused_;
}

void ImageFeed::run() {
  bool running = awaitSubscriber();
  while (running) running = step();
  const std::lock_guard<std::mutex> lock(mutex_);
  counts_.finished = true;
}

bool ImageFeed::awaitSubscriber() {
  if (source_->isLive() || !params_.wait_for_subscriber) return true;
  while (!outlet_.has_subscriber())
    if (!sleepFor(kLook)) return false;
  return sleepFor(kSettle);
}

// Returns false at the end.
bool ImageFeed::step() {
  if (!open_) return openSource() ? sleepUntil(Clock::now()) : sleepFor(kRetry);
  if (!sleepUntil(source_->isLive() ? Clock::now() : pace_.due(Clock::now()))) return false;
  if (!grab()) return afterLast();
  take(ros::Time::now());
  return params_.frames == 0 || counts().published < static_cast<unsigned long>(params_.frames);
}

bool ImageFeed::openSource() {
  try {
    source_->open();
  } catch (const std::exception& error) {
    trouble_.report("source", error.what());
    return false;
  }
  open_ = true;
  noteRefusedSettings();
  if (count(&Counts::opened) > 1 && source_->isLive()) ROS_INFO("the camera is back");
  return true;
}

void ImageFeed::noteRefusedSettings() {
  std::string refused;
  for (const std::string& text : source_->refusedSettings()) refused += (refused.empty() ? "" : "; ") + text;
  if (!refused.empty()) trouble_.report("setting", refused);
  const std::lock_guard<std::mutex> lock(mutex_);
  refused_ = refused;
}

bool ImageFeed::grab() {
  try {
    return source_->grab();
  } catch (const std::exception& error) {
    trouble_.report("grab", error.what());
    return false;
  }
}

bool ImageFeed::afterLast() {
  open_ = false;
  if (!source_->isLive()) return params_.loop;
  trouble_.report("camera lost", "the camera sends no images any more; trying to reopen it every second");
  return sleepFor(kRetry);
}

void ImageFeed::take(const ros::Time& stamp) {
  trouble_.succeeded();
  if (!isDue() || !outlet_.needs_image()) {
    count(&Counts::skipped);
    return;
  }
  try {
    if (stamp.isZero())
      throw std::runtime_error("no time for the stamp: use_sim_time is set, but nothing publishes /clock");
    outlet_.publish(source_->retrieve(), stamp);
    count(&Counts::published);
  } catch (const std::exception& error) {
    trouble_.report("image", error.what());
  }
}

bool ImageFeed::isDue() {
  const Clock::time_point now = Clock::now();
  if (!source_->isLive() && now > pace_.due(now) + RateLimit::period(rate())) count(&Counts::late);
  return pace_.passes(now, rate());
}

double ImageFeed::rate() const { return params_.rate > 0 ? params_.rate : source_->recordedRate(); }

// Returns false if the feed must stop.
bool ImageFeed::sleepUntil(Clock::time_point time) {
  std::unique_lock<std::mutex> lock(mutex_);
  return !wake_.wait_until(lock, time, [this] { return stop_; });
}

unsigned long ImageFeed::count(unsigned long Counts::*which) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return ++(counts_.*which);
}

}  // namespace sextant
