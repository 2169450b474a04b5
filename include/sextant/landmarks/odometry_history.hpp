// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/odometry_noise.hpp"

namespace sextant {

/// Recent odometry readings.
class OdometryHistory {
 public:
  /// @param span seconds of readings that are kept before the last but one
  OdometryHistory(const OdometryNoiseParams& params, double span) : params_(params), span_(span) {}

  /// Adds a reading. @param stamp seconds @returns false if it is not newer than the last one; it is ignored
  /// then
  bool add(double stamp, const Pose2& T_odom_base);

  /// Motion between two stamps, interpolated linearly between readings; nothing if one of them is outside of
  /// the readings that are kept.
  std::optional<OdometryStep> between(double from, double to) const;

  std::optional<Pose2> at(double stamp) const;              ///< T_odom_base, interpolated
  bool empty() const { return readings_.empty(); }          ///< whether there is no reading
  double first() const { return readings_.front().stamp; }  ///< oldest stamp, seconds
  double last() const { return readings_.back().stamp; }    ///< newest stamp, seconds
  void clear() { readings_.clear(); }                       ///< removes all readings

 private:
  struct Reading {
    double stamp;
    Pose2 T_odom_base;
  };
  using Readings = std::deque<Reading>;
  Readings::const_iterator after(double stamp) const;

  OdometryNoiseParams params_;
  double span_;
  Readings readings_;
};

}  // namespace sextant
