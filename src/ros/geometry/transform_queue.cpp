// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/geometry/transform_queue.hpp"

#include "sextant/ros/geometry/transform_lookup.hpp"

namespace sextant {

void TransformQueue::process(const std::string& target, const OnTimeout& on_timeout) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  for (auto item = items_.begin(); item != items_.end();) {
    const TransformLookup found = lookUp(buffer_, target, item->header.frame_id, item->header.stamp);
    if (!found.T_target_source && now < item->deadline) {
      ++item;
      continue;
    }
    found.T_target_source ? item->work(*found.T_target_source) : on_timeout(found.reason);
    item = items_.erase(item);
  }
}

}  // namespace sextant
