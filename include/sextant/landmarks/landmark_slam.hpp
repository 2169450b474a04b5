// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "sextant/base/params.hpp"
#include "sextant/landmarks/landmark_association.hpp"
#include "sextant/landmarks/landmark_candidates.hpp"
#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_matching.hpp"
#include "sextant/landmarks/landmark_register.hpp"
#include "sextant/landmarks/landmark_sensor.hpp"
#include "sextant/landmarks/lost_watch.hpp"

namespace sextant {

struct LandmarkSlamParams {
  LandmarkFilterParams filter;
  AssociationParams association;
  CandidateParams candidates;
  LandmarkSensorParams sensor;
  LandmarkMatchingParams matching;
  int lost_after = 10;
  bool read_only = false;

  ParamList fields();
};

/// What became of the sightings of a moment.
struct LandmarkReport {
  int known = 0, begun = 0, doubtful = 0,
      waiting = 0;              ///< sightings; begun: a landmark; waiting: a candidate
  int rejected = 0;             ///< sightings whose id is of a landmark that is surely elsewhere
  int merged = 0, removed = 0;  ///< landmarks
  bool lost = false;            ///< where the robot is is not known
  double nis = 0;
  int nis_width = 0;
  std::vector<std::optional<int>> keys;  ///< of the landmark that each sighting is of, where it is known
};

/// Localization and mapping with landmarks that come, are found to be one, and go.
class LandmarkSlam {
 public:
  /// @throws std::invalid_argument as validate(LandmarkSlamParams) and LandmarkFilter's constructor
  LandmarkSlam(const LandmarkSlamParams& params, const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// As LandmarkFilter::predict().
  void predict(const OdometryStep& step, double duration = 0);

  /// All that one sensor sees at one moment; nothing, where it looked and saw nothing. @param stamp seconds
  /// @param T_base_sensor whose x axis is the middle of what it sees
  LandmarkReport see(double stamp, const std::vector<LabelledSighting>& sightings,
                     const Pose2& T_base_sensor = {});

  const LandmarkFilter& filter() const { return register_.filter(); }
  const std::vector<LandmarkLabel>& labels() const {
    return register_.labels();
  }  ///< of filter().landmarks()
  const std::vector<int>& keys() const {
    return register_.keys();
  }  ///< of each, the same as long as it lives
  size_t candidates() const { return candidates_.size(); }

  /// Where the robot is is not known any more: from what it sees from now on it makes a map of its own, until
  /// that is found in the one that was there before. Without landmarks there is nothing to find, and nothing
  /// is lost.
  void lose();
  bool isLost() const { return !local_.empty(); }

  /// As LandmarkFilter::setPose(); not lost then.
  void setPose(const Pose2& T_map_base, const Eigen::Matrix3d& covariance);

  /// A map from elsewhere. @param covariance as LandmarkFilter::setState()
  void setMap(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
              const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance);

 private:
  /// Sightings by what they are of.
  struct Sorted {
    std::vector<KnownSighting> known;
    std::vector<LabelledSighting> unknown;
    std::vector<size_t> seen, missed, elsewhere;  // landmarks; elsewhere: their ids are
  };
  LandmarkReport seeKnown(double stamp, const std::vector<LabelledSighting>& sightings,
                          const Pose2& T_base_sensor);
  LandmarkReport seeLost(double stamp, const std::vector<LabelledSighting>& sightings,
                         const Pose2& T_base_sensor);
  Sorted sorted(const std::vector<size_t>& near, const std::vector<LabelledSighting>& sightings,
                const Pose2& T_base_sensor, LandmarkReport& report);
  Sorted byOrigin(const std::vector<Association>& origins, const std::vector<LabelledSighting>& sightings,
                  LandmarkReport& report) const;
  std::vector<Association> associated(const std::vector<size_t>& near, const SightingPrediction& expected,
                                      const std::vector<LabelledSighting>& sightings);
  Association associatedById(const LabelledSighting& sighting);
  std::vector<size_t> inReach(const std::vector<LabelledSighting>& sightings) const;
  void begin(double stamp, const std::vector<LabelledSighting>& unknown, LandmarkReport& report);
  void watch(const Sorted& sorted, const LandmarkReport& report);
  bool isElsewhere();
  void join(const LandmarkMatch& match);
  void beginAnew();

  LandmarkSlamParams params_;
  LandmarkSensor sensor_;
  LandmarkRegister register_;
  LandmarkCandidates candidates_;
  LostWatch watch_;
  std::shared_ptr<const LandmarkRegister> trusted_;  // of the time before it seemed that the robot is lost
  size_t fresh_ = 0;                                 // landmarks since, that were sought in it
  int looks_ = 0;                                    // of one that is lost
  std::vector<LandmarkSlam> local_;                  // of a robot that is lost: one, in a frame of its own
};

}  // namespace sextant
