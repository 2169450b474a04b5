// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_hypotheses.hpp"
#include "sextant/landmarks/odometry_history.hpp"

namespace sextant {

/// Parameters of LandmarkTimeline.
struct LandmarkTimelineParams {
  OdometryNoiseParams odometry;  ///< noise of the odometry
  double lag = 1.0;
  double clock_offset = 0.0;
  int max_observations = 100;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// What is done with a scan or an image when it arrives.
enum class Arrival {
  applied,    ///< applied at its own stamp
  waiting,    ///< waits for odometry of its stamp
  too_late,   ///< delayed by more than the lag, or older than the first odometry
  duplicate,  ///< received before
  too_large,  ///< more observations than max_observations
};

/// Runs LandmarkSlam on scans and images that arrive late, twice or out of order: each is applied at its own
/// stamp, and later ones are applied again after it.
class LandmarkTimeline {
 public:
  /// @throws std::invalid_argument as validate(LandmarkTimelineParams)
  LandmarkTimeline(const LandmarkTimelineParams& params, const LandmarkSlam& slam);

  /// Adds an odometry reading and applies the scans that waited for it. @param stamp seconds
  /// @returns false if it is not newer than the last one; it is ignored then
  bool odometry(double stamp, const Pose2& T_odom_base);

  /// Adds a scan, as LandmarkSlam::observe(). @param stamp seconds, by the clock of the sensor
  Arrival observe(double stamp, const std::vector<LabelledObservation>& observations,
                  const Pose2& T_base_sensor = {}, Detects detects = Detects::all);

  /// Adds the recognized places of an image, as LandmarkHypotheses::observePlaces().
  /// @param stamp seconds, by the clock of odometry
  Arrival observePlaces(double stamp, const std::vector<PossiblePose>& poses);

  /// Pose of the robot at the newest odometry.
  struct Now {
    double stamp;                ///< seconds
    Pose2 T_map_base;            ///< predicted from the newest scan
    Eigen::Matrix3d covariance;  ///< of (x, y, heading) in the map frame
    Pose2 T_map_odom;            ///< constant between scans
  };

  /// Current pose; nothing before the first odometry.
  std::optional<Now> now() const;

  /// State after the newest scan.
  const LandmarkHypotheses& hypotheses() const { return newest().hypotheses; }
  /// The most probable of hypotheses().
  const LandmarkSlam& slam() const { return hypotheses().best(); }

  /// A scan or an image that was applied.
  struct Applied {
    double stamp;                        ///< seconds, as received
    Detects detects;                     ///< what the sensor of a scan detects
    LandmarkReport report;               ///< result of a scan
    std::optional<PlaceUse> places;      ///< result of an image
    std::vector<PoseSource> wrong = {};  ///< LandmarkHypotheses::wrongSources() afterwards
  };

  /// Scans and images that the last odometry(), observe() or observePlaces() applied for the first time.
  const std::vector<Applied>& applied() const { return applied_; }
  /// Number of odometry jumps larger than any robot can drive; odometry restarts and the robot is lost after
  /// each.
  int jumps() const { return jumps_; }
  size_t waiting() const { return waiting_.size(); }  ///< number of scans that wait for odometry

  /// Changes the state at the newest odometry, for instance the pose or the map; earlier scans are dropped.
  template <typename Change>
  void change(Change&& change) {
    State state = advanced(newest(), history_.empty() ? newest().stamp : history_.last());
    change(state.hypotheses.settled());
    reset(state);
  }

  /// Drops odometry and scans and keeps the map; the caller sets the pose.
  void restart();

 private:
  struct State {
    double stamp;
    LandmarkHypotheses hypotheses;
  };
  struct Scan {
    double stamp, received_stamp;  // by the clock of odometry, and as received
    std::vector<LabelledObservation> observations;
    Pose2 T_base_sensor;
    Detects detects = Detects::all;
    std::optional<std::vector<PossiblePose>> places = {};  // of an image, which has no observations
    std::optional<State> after = {};  // state after the scan: of the newest and of some earlier ones
    bool is_reported = false;
  };
  using Scans = std::deque<Scan>;
  const State& newest() const;
  State advanced(State state, double stamp) const;
  void reset(const State& state);
  Arrival add(const Scan& scan);
  void apply(Scan scan);
  static Applied applyTo(State& state, const Scan& scan);
  void removeSettled();
  void wait(const Scan& scan);
  bool isJump(double stamp, const Pose2& T_odom_base) const;
  void restartLost();
  static bool isBefore(const Scan& a, const Scan& b) { return a.stamp < b.stamp; }
  Scans::iterator firstToReplay(Scans::iterator scan);
  bool isKept(Scans::iterator scan);
  State stateBefore(Scans::iterator scan);

  LandmarkTimelineParams params_;
  OdometryHistory history_;
  State base_;                 // before all scans
  Scans scans_;                // by stamp
  std::vector<Scan> waiting_;  // by stamp
  int jumps_ = 0;
  std::vector<Applied> applied_;
};

}  // namespace sextant
