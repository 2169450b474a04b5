// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/odometry_steps.hpp"

namespace sextant {

struct LandmarkTimelineParams {
  OdometryNoiseParams odometry;
  double lag = 1.0;
  double clock_offset = 0.0;

  ParamList fields();
};

/// What became of sightings.
enum class Arrival {
  taken,      ///< at their own stamp
  waiting,    ///< for odometry of their moment
  too_late,   ///< older than the lag, or than odometry
  duplicate,  ///< the same came before
};

/// Runs LandmarkSlam on odometry and sightings that come late, twice, or out of order: each is applied at its
/// own stamp, and what was applied after it is applied again.
class LandmarkTimeline {
 public:
  /// @throws std::invalid_argument as validate(LandmarkTimelineParams)
  LandmarkTimeline(const LandmarkTimelineParams& params, const LandmarkSlam& slam);

  /// @returns whether the reading was taken; it is not newer than the last one otherwise
  bool odometry(double stamp, const Pose2& T_odom_base);

  /// @param T_base_sensor as LandmarkSlam::see()
  Arrival see(double stamp, const std::vector<LabelledSighting>& sightings, const Pose2& T_base_sensor = {});

  /// The robot at the last odometry; nothing before the first.
  struct Now {
    double stamp;
    Pose2 T_map_base;
    Eigen::Matrix3d covariance;  ///< (x, y, heading), map's axes
    Pose2 T_map_odom;            ///< changes with sightings only
  };
  std::optional<Now> now() const;

  /// As it was after the newest sightings.
  const LandmarkSlam& slam() const { return newest().slam; }

  /// Sightings of one moment that came into the estimate.
  struct Applied {
    double stamp;  ///< that they came with
    LandmarkReport report;
  };
  /// Those that the last odometry() or see() brought in. Those of later moments, which were gone through
  /// again then, are not told again.
  const std::vector<Applied>& applied() const { return applied_; }
  /// How often odometry leapt farther than anything drives: it begins anew then, and the robot is lost.
  int leaps() const { return leaps_; }
  size_t waiting() const { return waiting_.size(); }  ///< moments, for odometry

  /// Changes all that is known, at the last odometry: another pose, another map. Sightings before it are
  /// gone.
  template <typename Change>
  void change(Change&& change) {
    State state = advanced(newest(), history_.empty() ? newest().stamp : history_.last());
    change(state.slam);
    begin(state);
  }

  /// Odometry and all that was seen are forgotten, the map is not; its owner says where the robot is.
  void restart();

 private:
  struct State {
    double stamp;
    LandmarkSlam slam;
  };
  struct Moment {
    double stamp, heard;  // by odometry's clock, and as it came
    std::vector<LabelledSighting> sightings;
    Pose2 T_base_sensor;
    std::optional<State> after = {};  // of the last moment, and of some before it
    bool is_told = false;
  };
  using Moments = std::deque<Moment>;
  const State& newest() const;
  State advanced(State state, double stamp) const;
  void begin(const State& state);
  void apply(Moment moment);
  void settle();
  void wait(const Moment& moment);
  bool isLeap(double stamp, const Pose2& T_odom_base) const;
  void beginElsewhere();
  static bool isBefore(const Moment& a, const Moment& b) { return a.stamp < b.stamp; }
  Moments::iterator afterKnown(Moments::iterator each);
  bool isKept(Moments::iterator each);
  State takenBefore(Moments::iterator each);

  LandmarkTimelineParams params_;
  OdometryHistory history_;
  State base_;                   // before all moments
  Moments moments_;              // by stamp
  std::vector<Moment> waiting_;  // by stamp
  int leaps_ = 0;
  std::vector<Applied> applied_;
};

}  // namespace sextant
