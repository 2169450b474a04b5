// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/kidnap_detector.hpp"
#include "sextant/landmarks/landmark_association.hpp"
#include "sextant/landmarks/landmark_candidates.hpp"
#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_map_matching.hpp"
#include "sextant/landmarks/landmark_register.hpp"
#include "sextant/landmarks/landmark_sensor.hpp"
#include "sextant/landmarks/noise_monitor.hpp"
#include "sextant/landmarks/scan_interpretation.hpp"

namespace sextant {

/// Parameters of LandmarkSlam.
struct LandmarkSlamParams {
  LandmarkFilterParams filter;         ///< of the UKF
  AssociationParams association;       ///< of data association
  CandidateParams candidates;          ///< of landmarks that are not confirmed yet
  LandmarkSensorParams sensor;         ///< of the sensor's field of view
  LandmarkMapMatchingParams matching;  ///< of relocalization
  int lost_after = 10;
  int hypotheses = 8;
  bool read_only = false;

  ParamList fields();  ///< names, ranges, units and descriptions
};

/// Result of one scan.
struct LandmarkReport {
  int associated = 0;   ///< observations of landmarks in the map
  int initialized = 0;  ///< observations that initialized a landmark
  int ambiguous = 0;    ///< observations not used: ambiguous, or an id that occurs twice in the scan
  int tentative = 0;    ///< observations of candidates; all observations while the robot is lost
  int rejected = 0;     ///< observations with an id, outside of the gate of the landmark with this id
  int missed = 0;       ///< landmarks without an id that should have been observed, and were not
  int unexpected = 0;   ///< observations of none, where the map is complete or landmarks are missed
  int excluded = 0;     ///< observations not applied, as they contradict the pose and their source is wrong
  int merged = 0;       ///< landmarks merged with another one
  int removed = 0;      ///< landmarks removed
  bool lost = false;    ///< whether the robot is lost
  double nis = 0;       ///< normalized innovation squared of the update
  int nis_dof = 0;      ///< its degrees of freedom; 0: no update
  std::vector<std::optional<int>> keys;  ///< key of the landmark of each observation, if associated
};

/// SLAM with data association: initializes, merges and removes landmarks, and relocalizes a lost robot.
class LandmarkSlam {
 public:
  /// @throws std::invalid_argument as validate(LandmarkSlamParams) and LandmarkFilter's constructor
  LandmarkSlam(const LandmarkSlamParams& params, const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// Moves the robot, as LandmarkFilter::predict().
  void predict(const OdometryStep& step, double duration = 0);

  /// Pose after a step, without changing the state; much faster than predict().
  PoseEstimate2D predictPose(const OdometryStep& step) const;

  /// Applies one scan of one sensor. @param stamp seconds
  /// @param observations in the robot frame; empty if the sensor detected nothing
  /// @param T_base_sensor its x axis is the viewing direction
  LandmarkReport observe(double stamp, const std::vector<LabelledObservation>& observations,
                         const Pose2& T_base_sensor = {});

  /// The most likely ways to explain a scan, the best first; at least one. @param most maximum number; 1:
  /// ambiguous observations are not used
  std::vector<ScanInterpretation> interpretations(const std::vector<LabelledObservation>& observations,
                                                  const Pose2& T_base_sensor, size_t most,
                                                  Detects detects = Detects::all);
  /// Applies one scan. @param how one of interpretations() of it
  LandmarkReport observe(double stamp, const std::vector<LabelledObservation>& observations,
                         const Pose2& T_base_sensor, const ScanInterpretation& how);

  const LandmarkSlamParams& params() const { return params_; }  ///< as constructed
  /// State and covariance.
  const LandmarkFilter& filter() const { return register_.filter(); }
  /// Label of each of filter().landmarks().
  const std::vector<LandmarkLabel>& labels() const { return register_.labels(); }
  /// Key of each of filter().landmarks(), constant while the landmark exists.
  const std::vector<int>& keys() const { return register_.keys(); }
  const NoiseMonitor& noise() const { return noise_; }      ///< of odometry and observations
  size_t candidates() const { return candidates_.size(); }  ///< number of landmark candidates

  /// Discards the pose: a local map is built from the next scans until it matches the map. If the map has no
  /// established landmarks, only removes the candidates and provisional landmarks.
  void relocalize();
  bool isLost() const { return !local_.empty(); }  ///< whether the pose is unknown

  /// The robot is lost, also if the map is empty: its pose is known only by setPose().
  void lose();

  /// Corrects the pose by a measured one with independent errors, whose covariance is of (x, y, heading) in
  /// the map frame. Correlations of the pose with the landmarks are dropped.
  void observePose(const PoseEstimate2D& measured);

  /// Replaces the pose, as LandmarkFilter::setPose(); ends relocalization.
  void setPose(const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// Replaces pose and map. @param covariance as LandmarkFilter::setState()
  void setMap(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
              const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance);

 private:
  /// Observations and landmarks of one scan, by association.
  struct ScanAssociation {
    std::vector<AssociatedObservation> known;
    std::vector<LabelledObservation> unknown;
    std::vector<PositionObservation> unused;  // in the map frame
    std::vector<size_t> observed;             // landmarks
    std::vector<size_t> detected, missed;     // landmarks without an id that were expected in view
    std::vector<size_t> relocated;            // landmarks whose id was observed outside of the gate
  };
  LandmarkReport observeLocalized(double stamp, const std::vector<LabelledObservation>& observations,
                                  const Pose2& T_base_sensor, const ScanInterpretation& how);
  LandmarkReport observeLost(double stamp, const std::vector<LabelledObservation>& observations,
                             const Pose2& T_base_sensor, const ScanInterpretation& how);
  std::vector<LabelledObservation> corrected(const std::vector<LabelledObservation>& observations,
                                             const Pose2& T_base_sensor) const;
  ScanAssociation groupByOutcome(const ScanInterpretation& how,
                                 const std::vector<LabelledObservation>& observations,
                                 LandmarkReport& report) const;
  bool canInitialize(const LabelledObservation& seen) const;
  void initialize(double stamp, const std::vector<LabelledObservation>& unknown, LandmarkReport& report);
  void compareWithMap(const ScanAssociation& scan, LandmarkReport& report) const;
  void noteView(const ScanAssociation& scan, const Pose2& T_base_sensor);
  void countDetections(const ScanAssociation& scan);
  void detectKidnapping(const ScanAssociation& scan, const LandmarkReport& report, bool slipped);
  bool provisionalLandmarksMatchElsewhere();
  void applyMatch(const LandmarkMapMatch& match);
  void clearHypotheses();
  void startLocalMap();

  LandmarkSlamParams params_;
  LandmarkSensor sensor_;
  LandmarkRegister register_;
  ExploredArea explored_;
  LandmarkCandidates candidates_;
  LandmarkCandidates unused_;  // of ambiguous observations, which do not become landmarks
  KidnapDetector kidnap_detector_;
  NoiseMonitor noise_;
  // register and area before the first scan that suggests that the robot is lost
  std::shared_ptr<const std::pair<LandmarkRegister, ExploredArea>> trusted_;
  size_t matched_size_ = 0;          // number of provisional landmarks at the last matching
  int lost_scans_ = 0;               // scans while lost
  double unconfirmed_ = 0;           // metres and radians driven since a landmark was associated
  std::vector<LandmarkSlam> local_;  // local map while lost, in its own frame: one or none
};

}  // namespace sextant
