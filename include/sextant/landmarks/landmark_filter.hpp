// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/covariance_store.hpp"
#include "sextant/landmarks/odometry_steps.hpp"
#include "sextant/landmarks/plane_sighting.hpp"
#include "sextant/landmarks/unscented_transform.hpp"

namespace sextant {

/// How LandmarkFilter works.
struct LandmarkFilterParams {
  double scale_sigma = 0.0;
  double scale_drift = 0.0;
  double clock_sigma = 0.0;

  ParamList fields();
};

/// A pose and what is not known of it: (x, y, heading), map's axes.
struct PlanePoseEstimate {
  Pose2 pose;
  Eigen::Matrix3d covariance;
};

/// Where landmarks should be seen.
struct SightingPrediction {
  Eigen::VectorXd positions;   ///< in the robot frame, (x, y[, heading]) one after another
  Eigen::MatrixXd covariance;  ///< of them all, without a sensor's noise
};

/// Simultaneous localization and mapping in the plane by an unscented Kalman filter over (robot, landmarks).
/// The nonlinear functions know only the robot and the landmarks that are seen, and so do the sigma points: a
/// step takes O(n^2). Public covariances are of (x, y, heading) and (x, y[, heading]) in the map's axes.
class LandmarkFilter {
 public:
  /// @param covariance of (x, y, heading) in the map's axes, positive definite
  /// @throws std::invalid_argument as validate(LandmarkFilterParams), or if the covariance is none
  LandmarkFilter(const LandmarkFilterParams& params, const Pose2& T_map_base,
                 const Eigen::Matrix3d& covariance);

  /// @param duration seconds; needed where the clock offset is estimated
  void predict(const OdometryStep& step, double duration = 0);

  /// Where the robot will be after a step, without what predict() costs.
  PlanePoseEstimate ahead(const OdometryStep& step) const;

  /// Sightings of one moment. Nothing happens where there are none.
  /// @throws std::invalid_argument where one landmark is seen twice
  void update(const std::vector<KnownSighting>& seen);
  /// @param noise covariance of all of them together, rows as of differences()
  void update(const std::vector<KnownSighting>& seen, const Eigen::MatrixXd& noise);

  /// @returns index of a new landmark
  size_t add(const PlaneSighting& sighting);

  /// Later indices move down by one.
  void remove(size_t landmark);

  /// Two landmarks that are one; the second is removed.
  void merge(size_t kept, size_t other);

  /// A robot that somebody put elsewhere: what it knew of its pose is forgotten.
  void setPose(const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// All of a map; what was known is forgotten. @param covariance of robot and landmarks, as covariance()
  /// @throws std::invalid_argument where its rows are not theirs; nothing has changed then
  void setState(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
                const Eigen::MatrixXd& covariance);

  /// @param headings also of the landmarks that have one
  SightingPrediction predicted(const std::vector<size_t>& landmarks, bool headings = false);

  const Pose2& pose() const { return state_.pose; }
  const std::vector<PlaneLandmark>& landmarks() const { return state_.landmarks; }
  double scale() const { return state_.scale; }        ///< what odometry measures is multiplied by it
  double clockOffset() const { return state_.clock; }  ///< seconds to add to the stamps of sightings
  double scaleVariance() const { return scale_at_ < 0 ? 0.0 : P_(scale_at_, scale_at_); }
  double clockVariance() const { return clock_at_ < 0 ? 0.0 : P_(clock_at_, clock_at_); }
  Eigen::MatrixXd covariance() const;  ///< of (x, y, heading) and all landmarks
  Eigen::MatrixXd covariance(const std::vector<size_t>& landmarks) const;  ///< of (x, y, heading) and these
  double nis() const { return nis_; }          ///< normalized innovation squared of the last update
  int nisWidth() const { return nis_width_; }  ///< its degrees of freedom
  int repairs() const { return repairs_; }     ///< of covariances that rounding made indefinite

 private:
  struct State {
    Pose2 pose;
    double scale = 1, clock = 0;
    std::vector<PlaneLandmark> landmarks;
  };

  using Innovation = std::function<Eigen::VectorXd(const Eigen::VectorXd& xi)>;

  std::vector<size_t> all() const;
  Indices indicesOf(size_t landmark) const;
  /// Of the pose and these; with the clock, all that sightings of them depend on.
  Indices indicesOf(const std::vector<size_t>& landmarks, bool with_clock = false) const;
  std::vector<PlaneLandmark> expected(const std::vector<size_t>& landmarks, const Eigen::VectorXd& xi) const;
  void propagate(const Pose2& step);
  void drift(Eigen::Index which, double deviation);
  Eigen::MatrixXd factor(const Indices& which);  ///< lower Cholesky factor of the block
  void fuse(const Indices& which, const Eigen::MatrixXd& R, const Innovation& innovation);
  void fusePart(const Indices& which, const Eigen::MatrixXd& L, const UnscentedMoments& moments,
                const Eigen::MatrixXd& R);
  void correct(const Eigen::VectorXd& xi);
  Eigen::VectorXd levers() const;                                        ///< (n) of all of xi
  Eigen::VectorXd leversOf(const std::vector<size_t>& landmarks) const;  ///< rows as indicesOf()
  Eigen::MatrixXd sheared(double sign) const;  ///< from xi to the map's axes; -1: back
  void setSheared(const Eigen::MatrixXd& plain);

  LandmarkFilterParams params_;
  State state_;
  CovarianceStore P_;  // of the error xi = (x, y, heading[, scale][, clock], landmarks)
  Eigen::Index scale_at_ = -1, clock_at_ = -1;
  std::vector<Eigen::Index> offsets_;  // of the landmarks in xi
  Pose2 speed_;                        // of the last step, per second
  double nis_ = 0;
  int nis_width_ = 0, repairs_ = 0;
};

}  // namespace sextant
