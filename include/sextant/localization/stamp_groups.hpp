// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace sextant {

/// Parameters of StampGroups.
struct StampGroupsParams {
  size_t cameras = 1;     ///< number of cameras
  double window = 0.01;   ///< maximum difference of the stamps in a group, seconds
  double timeout = 0.05;  ///< maximum time to wait for the other cameras, seconds
};

/// Groups messages of several cameras by stamp, the oldest group first. Does not wait for a camera that has
/// been silent for a second.
/// @tparam Item message of a camera
template <typename Item>
class StampGroups {
 public:
  /// A message of a group.
  struct Member {
    size_t camera;  ///< index of the camera
    Item item;      ///< the message
  };

  /// Starts without messages.
  explicit StampGroups(const StampGroupsParams& params) : params_(params), cameras_(params.cameras) {}

  /// Adds a message. @param stamp of the image, seconds; @param now time of a steady clock, seconds
  void add(size_t camera, double stamp, double now, Item item) {
    cameras_[camera].waiting.push_back({stamp, now, std::move(item)});
    cameras_[camera].last_message = now;
  }

  /// Removes and returns the oldest group if it is complete or its timeout has expired.
  std::optional<std::vector<Member>> take(double now) {
    const Entry* first = oldest();
    if (!first || (now < first->arrival + params_.timeout && !complete(now))) return std::nullopt;
    const double latest_stamp = first->stamp + params_.window;
    std::vector<Member> group;
    for (size_t i = 0; i < cameras_.size(); ++i) {
      auto& waiting = cameras_[i].waiting;
      if (waiting.empty() || waiting.front().stamp > latest_stamp) continue;
      group.push_back({i, std::move(waiting.front().item)});
      waiting.pop_front();
    }
    return group;
  }

  /// Whether no message is waiting.
  bool empty() const { return !oldest(); }
  /// Removes all messages.
  void clear() { cameras_.assign(params_.cameras, {}); }

 private:
  static constexpr double kSilent = 1.0;  // seconds without a message after which a camera is silent

  struct Entry {
    double stamp, arrival;
    Item item;
  };
  struct Camera {
    std::deque<Entry> waiting;
    double last_message = -std::numeric_limits<double>::infinity();
  };

  const Entry* oldest() const {
    const Entry* first = nullptr;
    for (const Camera& camera : cameras_)
      if (!camera.waiting.empty() && (!first || camera.waiting.front().stamp < first->stamp))
        first = &camera.waiting.front();
    return first;
  }

  // Whether no camera has to be waited for: each has a message of this instant or a later one, or is silent.
  bool complete(double now) const {
    return std::all_of(cameras_.begin(), cameras_.end(), [&](const Camera& camera) {
      return !camera.waiting.empty() || now - camera.last_message > kSilent;
    });
  }

  StampGroupsParams params_;
  std::vector<Camera> cameras_;
};

}  // namespace sextant
