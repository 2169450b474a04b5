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

#include "sextant/ros/base/rate_limit.hpp"
#include "sextant/ros/base/trouble_log.hpp"
#include "sextant/ros/images/image_source.hpp"

namespace sextant {

/// Plays a source in a thread of its own: keeps the pace, stamps at the grab, opens a lost device again every
/// second, decodes only what somebody wants.
class ImagePlayer {
 public:
  /// Called in the player's thread.
  struct Outlet {
    std::function<bool()> awaited;  ///< who a file waits for is there
    std::function<bool()> wanted;   ///< somebody needs the next picture
    std::function<void(const cv::Mat&, const ros::Time&)> publish;
  };
  struct Counts {
    unsigned long published = 0;
    unsigned long skipped = 0;  ///< grabbed, but nobody listened or the rate did not need it
    unsigned long late = 0;     ///< of a file: more than its period behind the pace
    unsigned long opened = 0;   ///< times that the source was opened or began anew
    bool finished = false;
  };

  /// Begins to play. @param trouble outlives the player
  ImagePlayer(std::unique_ptr<ImageSource> source, const ImagePlayerParams& params, Outlet outlet,
              TroubleLog& trouble);
  /// Waits for the picture under way at most.
  ~ImagePlayer();

  Counts counts() const;

 private:
  using Clock = RateLimit::Clock;

  void run();
  bool step();
  bool awaitListener();
  bool openSource();
  bool grab();
  bool afterLast();
  void take(const ros::Time& stamp);
  bool isDue();
  double rate() const;
  bool sleepUntil(Clock::time_point time);
  bool sleepFor(Clock::duration duration) { return sleepUntil(Clock::now() + duration); }
  unsigned long count(unsigned long Counts::*which);

  std::unique_ptr<ImageSource> source_;
  ImagePlayerParams params_;
  Outlet outlet_;
  TroubleLog& trouble_;
  bool open_ = false;
  RateLimit pace_;
  Counts counts_;
  mutable std::mutex mutex_;  // of counts_ and stop_
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace sextant
