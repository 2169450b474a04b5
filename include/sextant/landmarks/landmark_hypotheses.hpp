// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/source_faults.hpp"

namespace sextant {

/// One pose that the robot may have, of several.
struct PossiblePose {
  Pose2 T_map_base;            ///< of the robot
  Eigen::Matrix3d covariance;  ///< of (x, y, heading) in the map frame
  double probability;          ///< (0, 1]
};

/// What is done with the places at which an image may have been taken.
enum class PlaceUse {
  unused,       ///< the place is probably unknown
  agrees,       ///< the pose is at one of the probable places
  contradicts,  ///< the pose is at another place; the places are improbable hypotheses until more supports
                ///< them
  relocalized,  ///< the pose is now one of these places
};

/// LandmarkSlam in which ambiguous decisions stay open (multi-hypothesis tracking, Reid 1979): while it is
/// not certain which landmarks were observed, or whether odometry slipped, one state is kept for each answer.
/// Later scans are more likely in the right one. The number of states is bounded, in large maps more than in
/// small ones; improbable ones are dropped, and of two that have become equal one is.
///
/// A source that contradicts the pose while others support it may be wrong: hypotheses that do not apply its
/// scans are kept, too, until the others decide. A wrong source is as consistent with itself as a right one,
/// so that its scans are no evidence against those.
class LandmarkHypotheses {
 public:
  /// @param slam the only hypothesis; its parameter `hypotheses` bounds their number
  explicit LandmarkHypotheses(const LandmarkSlam& slam) : all_{{slam}} {}

  /// Moves the robot in all of them, as LandmarkSlam::predict().
  void predict(const OdometryStep& step, double duration = 0);

  /// Applies one scan, as LandmarkSlam::observe(). @returns the report of the best hypothesis
  LandmarkReport observe(double stamp, const std::vector<LabelledObservation>& observations,
                         const Pose2& T_base_sensor = {}, Detects detects = Detects::all);

  /// Applies the recognized places of an image, which are evidence for and against each hypothesis; those
  /// that are in none become improbable hypotheses. Images nearby err alike: until a landmark is associated,
  /// their evidence increases with the motion between them. The evidence of images against a hypothesis is
  /// bounded, as they may show the same error again and again, unless no landmark was associated in it for
  /// long. A lost robot is at one of the places. A hypothesis without landmarks for a while is corrected by
  /// its place.
  /// @param poses their probabilities sum to at most 1; the rest is that of an unknown place
  PlaceUse observePlaces(const std::vector<PossiblePose>& poses);
  /// Whether a landmark was associated in the best hypothesis, if its pose is that of a place.
  bool isConfirmed() const { return all_.front().is_confirmed; }

  /// Sources that the best hypothesis takes to be wrong, as another source has confirmed.
  std::vector<PoseSource> wrongSources() const;

  /// Pose of the best hypothesis after a step; its covariance covers the poses of the others, except for the
  /// least probable ones, which together have a probability below 0.001.
  PoseEstimate2D predictPose(const OdometryStep& step) const;

  const LandmarkSlam& best() const { return all_.front().slam; }  ///< the most probable one
  size_t size() const { return all_.size(); }                     ///< number of hypotheses
  double probability() const;                                     ///< of the best one

  /// Drops all but the best, which may then be changed.
  LandmarkSlam& settled();

 private:
  struct Hypothesis {
    LandmarkSlam slam;
    double log_weight = 0;     // of observations, relative to the best
    double log_places = 0;     // of images, relative to that which fits best
    bool is_confirmed = true;  // whether a landmark was associated since it was at a place
    double unmeasured = 0;     // metres driven since a landmark was associated or a place corrected the pose
    SourceFaults faults = {};  // sources that it takes to be wrong
    bool is_aside = false;     // whether it is lost, while others are not
    LandmarkReport report = {};

    double weight() const { return log_weight + log_places; }  // natural logarithm
  };
  /// What becomes of a hypothesis with a scan.
  struct Child {
    size_t parent;  // index of the hypothesis
    ScanInterpretation how;
    double log_weight;  // of the parent and the scan
    bool is_applied;    // or its source is excluded
  };
  struct Scan {
    double stamp;
    const std::vector<LabelledObservation>& observations;
    const Pose2& T_base_sensor;
    Detects detects;
  };
  std::vector<Child> childrenOf(const Scan& scan, size_t most);
  void addChildren(const Scan& scan, size_t parent, size_t most, std::vector<Child>& found);
  void weigh(const Scan& scan, std::vector<Child>& found) const;
  static bool excludes(const Scan& scan, const Child& child, const Hypothesis& to);
  static void apply(const Scan& scan, const Child& child, Hypothesis& to);
  static std::vector<Hypothesis> withoutLost(std::vector<Hypothesis> all);
  static double weightWithoutFaults(const std::vector<Hypothesis>& all);
  static std::vector<Hypothesis> setAside(std::vector<Hypothesis> all);
  static std::vector<Hypothesis> withoutEqual(std::vector<Hypothesis> all);
  static std::vector<Hypothesis> sorted(std::vector<Hypothesis> all);
  static void judge(Hypothesis& hypothesis, const std::vector<PossiblePose>& poses, double evidence);
  static void boundPlaces(std::vector<Hypothesis>& all);
  double evidenceOfImage() const;
  void place(const std::vector<PossiblePose>& poses);
  void addPlaces(const std::vector<PossiblePose>& poses);
  static std::vector<Hypothesis> likely(std::vector<Hypothesis> all, size_t most);
  size_t affordable() const;
  std::vector<double> probabilities() const;

  std::vector<Hypothesis> all_;  // the best first; never empty
  double since_image_ = 0;       // metres and radians driven since the last image
};

}  // namespace sextant
