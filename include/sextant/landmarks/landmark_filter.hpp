// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/geometry/pose2.hpp"
#include "sextant/landmarks/covariance_store.hpp"
#include "sextant/landmarks/observation_2d.hpp"
#include "sextant/landmarks/odometry_noise.hpp"
#include "sextant/landmarks/unscented_transform.hpp"

namespace sextant {

/// Parameters of LandmarkFilter.
struct LandmarkFilterParams {
  double scale_sigma = 0.0;
  double scale_drift = 0.0;
  double turn_scale_sigma = 0.0;
  double clock_sigma = 0.0;
  double bearing_sigma = 0.0;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// A planar pose with its covariance.
struct PoseEstimate2D {
  Pose2 pose;                  ///< T_map_base
  Eigen::Matrix3d covariance;  ///< of (x, y, heading) in the map frame
};

/// Predicted observations of landmarks.
struct ObservationPrediction {
  Eigen::VectorXd positions;   ///< in the robot frame, (x, y[, heading]) of each landmark
  Eigen::MatrixXd covariance;  ///< of all rows, without sensor noise
};

/// Planar SLAM with an unscented Kalman filter over the robot pose and the landmarks. Sigma points are drawn
/// only for the robot and the observed landmarks, so that an update takes O(n^2) for n landmarks. Public
/// covariances are of (x, y, heading) of the robot and (x, y[, heading]) of each landmark, in the map frame.
class LandmarkFilter {
 public:
  /// @param covariance of (x, y, heading) in the map frame
  /// @throws std::invalid_argument as validate(LandmarkFilterParams), or if the covariance is not positive
  /// definite
  LandmarkFilter(const LandmarkFilterParams& params, const Pose2& T_map_base,
                 const Eigen::Matrix3d& covariance);

  /// Moves the robot by one odometry step. @param duration seconds; needed if the clock offset is estimated
  void predict(const OdometryStep& step, double duration = 0);

  /// Pose after a step, without changing the filter; much faster than predict().
  PoseEstimate2D predictPose(const OdometryStep& step) const;

  /// Corrects the state with the observations of one scan; does nothing if there are none.
  /// @throws std::invalid_argument if a landmark is observed twice
  void update(const std::vector<AssociatedObservation>& observations);
  /// @param noise joint covariance of the observations, rows as innovations()
  void update(const std::vector<AssociatedObservation>& observations, const Eigen::MatrixXd& noise);

  /// Initializes a landmark from its first observation. @returns its index
  size_t add(const Observation2D& observation);

  /// Removes a landmark; the indices of later ones decrease by one.
  void remove(size_t landmark);

  /// Fuses two landmarks that are the same object; removes the second.
  void merge(size_t kept, size_t other);

  /// Replaces the pose; its correlation with the landmarks is lost.
  void setPose(const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// Replaces the pose and the map. @param covariance of robot and landmarks, as covariance()
  /// @throws std::invalid_argument if it has another size; the state is unchanged then
  void setState(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
                const Eigen::MatrixXd& covariance);

  /// Predicts observations at the current pose. @param headings whether to predict the headings, too
  ObservationPrediction predictObservations(const std::vector<size_t>& landmarks, bool headings = false);

  const Pose2& pose() const { return state_.pose; }                              ///< T_map_base
  const std::vector<Landmark2D>& landmarks() const { return state_.landmarks; }  ///< in the map frame
  /// Estimated factor by which the distances of odometry are multiplied.
  double scale() const { return state_.scale; }
  /// Estimated factor by which the angles of odometry are multiplied.
  double turnScale() const { return state_.turn_scale; }
  double clockOffset() const { return state_.clock; }  ///< seconds to add to the stamps of observations
  double bearing() const { return state_.bearing; }    ///< radians to add to the bearings of observations
  double scaleVariance() const { return varianceOf(scale_index_); }      ///< of scale(); 0: not estimated
  double turnScaleVariance() const { return varianceOf(turn_index_); }   ///< of turnScale(); 0: not estimated
  double clockVariance() const { return varianceOf(clock_index_); }      ///< s^2; 0: not estimated
  double bearingVariance() const { return varianceOf(bearing_index_); }  ///< rad^2; 0: not estimated
  Eigen::MatrixXd covariance() const;  ///< of (x, y, heading) and all landmarks
  Eigen::MatrixXd covariance(
      const std::vector<size_t>& landmarks) const;  ///< of (x, y, heading) and these landmarks
  double nis() const { return nis_; }               ///< normalized innovation squared of the last update
  int nisDof() const { return nis_dof_; }           ///< its degrees of freedom
  /// Share of the state in the covariance of the last update's innovation, in [0, 1].
  double nisStateShare() const { return nis_state_share_; }
  /// Number of times that a covariance was repaired because rounding had made it indefinite.
  int repairs() const { return repairs_; }

 private:
  struct State {
    Pose2 pose;
    double scale = 1, turn_scale = 1, clock = 0, bearing = 0;
    std::vector<Landmark2D> landmarks;
  };

  using Innovation = std::function<Eigen::VectorXd(const Eigen::VectorXd& xi)>;

  std::vector<size_t> all() const;
  Indices stateIndices(size_t landmark) const;
  /// Indices of the pose, clock offset and bearing if requested, and these landmarks.
  Indices stateIndices(const std::vector<size_t>& landmarks, bool with_sensor = false) const;
  double varianceOf(Eigen::Index index) const { return index < 0 ? 0.0 : P_(index, index); }
  std::vector<Landmark2D> predictedLandmarks(const std::vector<size_t>& landmarks,
                                             const Eigen::VectorXd& xi) const;
  Pose2 scaled(const OdometryStep& odometry) const;
  void addCorrelated(const Eigen::VectorXd& direction, Eigen::Index which);
  void drift(Eigen::Index which, double deviation);
  Eigen::MatrixXd factor(const Indices& which);  ///< lower Cholesky factor of a block of the covariance
  void fuse(const Indices& which, const Eigen::MatrixXd& R, const Innovation& innovation);
  void fusePart(const Indices& which, const Eigen::MatrixXd& L, const UnscentedMoments& moments,
                const Eigen::MatrixXd& R);
  void correct(const Eigen::VectorXd& xi);
  Eigen::VectorXd headingJacobian() const;  ///< (n) of the whole error xi
  Eigen::VectorXd headingJacobianOf(const std::vector<size_t>& landmarks) const;  ///< rows as stateIndices()
  Eigen::MatrixXd mapFrameCovariance(double sign) const;  ///< of map-frame errors from xi; -1: inverse
  void setMapFrameCovariance(const Eigen::MatrixXd& covariance);

  LandmarkFilterParams params_;
  State state_;
  CovarianceStore
      P_;  // of the error xi = (x, y, heading[, scale][, turn_scale][, clock][, bearing], landmarks)
  Eigen::Index scale_index_ = -1, turn_index_ = -1, clock_index_ = -1, bearing_index_ = -1;
  std::vector<Eigen::Index> offsets_;  // of the landmarks in xi
  Pose2 velocity_;                     // of the last step, per second
  double nis_ = 0, nis_state_share_ = 0;
  int nis_dof_ = 0, repairs_ = 0;
};

}  // namespace sextant
