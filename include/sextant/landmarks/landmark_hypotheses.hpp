// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/landmarks/landmark_slam.hpp"

namespace sextant {

/// One pose that the robot may have, of several.
struct PossiblePose {
  Pose2 T_map_base;            ///< of the robot
  Eigen::Matrix3d covariance;  ///< of (x, y, heading) in the map frame
  double probability;          ///< (0, 1]
};

/// LandmarkSlam in which ambiguous decisions stay open (multi-hypothesis tracking, Reid 1979): while it is
/// not certain which landmarks were observed, or whether odometry slipped, one state is kept for each answer.
/// Later scans are more likely in the right one. The number of states is bounded, in large maps more than in
/// small ones; improbable ones are dropped, and of two that have become equal one is.
class LandmarkHypotheses {
 public:
  /// @param slam the only hypothesis; its parameter `hypotheses` bounds their number
  explicit LandmarkHypotheses(const LandmarkSlam& slam) : all_{{slam, 0, {}}} {}

  /// Moves the robot in all of them, as LandmarkSlam::predict().
  void predict(const OdometryStep& step, double duration = 0);

  /// Applies one scan, as LandmarkSlam::observe(). @returns the report of the best hypothesis
  LandmarkReport observe(double stamp, const std::vector<LabelledObservation>& observations,
                         const Pose2& T_base_sensor = {});

  /// Makes one hypothesis of each pose, of the most probable ones if there are too many. The map is that of
  /// the best hypothesis, without the landmarks that may have been initialized at a wrong pose.
  /// @param poses at least one
  void place(const std::vector<PossiblePose>& poses);
  /// Whether a landmark was associated since the last place(); true before the first one.
  bool isConfirmed() const { return is_confirmed_; }

  /// Pose of the best hypothesis after a step; its covariance covers the poses of the others.
  PoseEstimate2D predictPose(const OdometryStep& step) const;

  const LandmarkSlam& best() const { return all_.front().slam; }  ///< the most probable one
  size_t size() const { return all_.size(); }                     ///< number of hypotheses
  double probability() const;                                     ///< of the best one

  /// Drops all but the best, which may then be changed.
  LandmarkSlam& settled();

 private:
  struct Hypothesis {
    LandmarkSlam slam;
    double log_weight;  // relative to the best
    LandmarkReport report;
  };
  static std::vector<Hypothesis> withoutLost(std::vector<Hypothesis> all);
  static std::vector<Hypothesis> withoutEqual(std::vector<Hypothesis> all);
  static std::vector<Hypothesis> sorted(std::vector<Hypothesis> all);
  size_t affordable() const;
  std::vector<double> probabilities() const;

  std::vector<Hypothesis> all_;  // the best first; never empty
  bool is_confirmed_ = true;
};

}  // namespace sextant
