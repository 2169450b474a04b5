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

/// Puts together what several cameras saw at nearly one instant.
struct StampGroupsParams {
  size_t cameras = 1;
  double window = 0.01;    ///< stamps of one group are no farther apart, seconds
  double patience = 0.05;  ///< how long the others are waited for, seconds
};

/// The oldest group comes first; a camera that has been silent for a second is not waited for.
/// @tparam Item what a camera gave
template <typename Item>
class StampGroups {
 public:
  struct Member {
    size_t camera;
    Item item;
  };

  explicit StampGroups(const StampGroupsParams& params) : params_(params), cameras_(params.cameras) {}

  /// @param stamp of the image, seconds; @param now by any steady clock, seconds
  void add(size_t camera, double stamp, double now, Item item) {
    cameras_[camera].waiting.push_back({stamp, now, std::move(item)});
    cameras_[camera].last_heard = now;
  }

  /// The oldest group, if nothing more is expected for it.
  std::optional<std::vector<Member>> take(double now) {
    const Entry* first = oldest();
    if (!first || (now < first->arrival + params_.patience && !complete(now))) return std::nullopt;
    const double last = first->stamp + params_.window;
    std::vector<Member> group;
    for (size_t i = 0; i < cameras_.size(); ++i) {
      auto& waiting = cameras_[i].waiting;
      if (waiting.empty() || waiting.front().stamp > last) continue;
      group.push_back({i, std::move(waiting.front().item)});
      waiting.pop_front();
    }
    return group;
  }

  bool empty() const { return !oldest(); }
  void clear() { cameras_.assign(params_.cameras, {}); }

 private:
  static constexpr double kSilent = 1.0;  // seconds

  struct Entry {
    double stamp, arrival;
    Item item;
  };
  struct Camera {
    std::deque<Entry> waiting;
    double last_heard = -std::numeric_limits<double>::infinity();
  };

  const Entry* oldest() const {
    const Entry* first = nullptr;
    for (const Camera& camera : cameras_)
      if (!camera.waiting.empty() && (!first || camera.waiting.front().stamp < first->stamp))
        first = &camera.waiting.front();
    return first;
  }

  // Every camera has given what it had for this instant, or something later, or is silent.
  bool complete(double now) const {
    return std::all_of(cameras_.begin(), cameras_.end(), [&](const Camera& camera) {
      return !camera.waiting.empty() || now - camera.last_heard > kSilent;
    });
  }

  StampGroupsParams params_;
  std::vector<Camera> cameras_;
};

}  // namespace sextant
