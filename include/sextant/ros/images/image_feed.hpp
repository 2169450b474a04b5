// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "sextant/images/image_source.hpp"
#include "sextant/ros/base/rate_limit.hpp"
#include "sextant/ros/base/trouble_log.hpp"

namespace sextant {

/// Feeds the images of a camera or of files to its outlet, in its own thread: keeps the rate, stamps images
/// when they are grabbed, reopens a lost device every second and decodes only images that are needed.
class ImageFeed {
 public:
  /// Callbacks, called in the feed's thread.
  struct Outlet {
    std::function<bool()> has_subscriber;                           ///< whether a file may start
    std::function<bool()> needs_image;                              ///< whether to decode the next image
    std::function<void(const cv::Mat&, const ros::Time&)> publish;  ///< publishes an image with its stamp
  };
  /// Numbers of images since the start.
  struct Counts {
    unsigned long published = 0;  ///< images published
    unsigned long skipped = 0;    ///< grabbed, but not decoded: no subscriber, or above the rate
    unsigned long late = 0;       ///< images of a file that were more than a period late
    unsigned long opened = 0;     ///< times that the source was opened or restarted
    bool finished = false;        ///< the source has ended
  };

  /// Starts the feed. @param trouble must outlive it
  ImageFeed(std::unique_ptr<ImageSource> source, const ImageFeedParams& params, Outlet outlet,
            TroubleLog& trouble);
  /// Stops after the current image.
  ~ImageFeed();

  Counts counts() const;  ///< may be called from any thread
  /// Settings that the device refused when it was last opened, for the user; empty: none. May be called from
  /// any thread.
  std::string refusedSettings() const;

 private:
  using Clock = RateLimit::Clock;

  void run();
  bool step();
  bool awaitSubscriber();
  bool openSource();
  void noteRefusedSettings();
  bool grab();
  bool afterLast();
  void take(const ros::Time& stamp);
  bool isDue();
  double rate() const;
  bool sleepUntil(Clock::time_point time);
  bool sleepFor(Clock::duration duration) { return sleepUntil(Clock::now() + duration); }
  unsigned long count(unsigned long Counts::*which);

  std::unique_ptr<ImageSource> source_;
  ImageFeedParams params_;
  Outlet outlet_;
  TroubleLog& trouble_;
  bool open_ = false;
  RateLimit pace_;
  Counts counts_;
  std::string refused_;
  mutable std::mutex mutex_;  // guards counts_, refused_ and stop_
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace sextant
