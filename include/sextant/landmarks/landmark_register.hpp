// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_map_matching.hpp"

namespace sextant {

/// The landmarks of a filter with their labels, keys and existence probabilities.
class LandmarkRegister {
 public:
  /// @throws std::invalid_argument as LandmarkFilter's constructor
  LandmarkRegister(const LandmarkFilterParams& params, const Pose2& T_map_base,
                   const Eigen::Matrix3d& covariance)
      : filter_(params, T_map_base, covariance) {}

  /// The filter over the robot pose and the landmarks, to predict and update; landmarks are added and removed
  /// by this class only. @{
  const LandmarkFilter& filter() const { return filter_; }
  LandmarkFilter& filter() { return filter_; }
  /// @}
  const std::vector<LandmarkLabel>& labels() const { return labels_; }  ///< of each landmark
  const std::vector<int>& keys() const { return keys_; }  ///< of each landmark, constant while it exists
  int nextKey() const { return next_key_; }               ///< key of the next new landmark
  std::optional<size_t> find(const LandmarkLabel& label) const;  ///< index of the first with it
  std::vector<MapPoint> points() const;                          ///< all landmarks
  /// All landmarks, in the robot frame.
  std::vector<MapPoint> pointsInRobotFrame();

  /// Initializes a landmark.
  void add(const LabelledObservation& observation);

  /// Adds evidence to the log odds that these landmarks exist, up to an upper bound.
  void addEvidence(const std::vector<size_t>& landmarks, double evidence);

  /// As addEvidence(), for landmarks that the sensor missed, if they count.
  void addMisses(const std::vector<size_t>& missed, const std::vector<size_t>& observed, double evidence);

  /// Whether it is evidence that the sensor missed this landmark. What hides a landmark hides it in every
  /// scan from the same direction, so that only the first one since the last change of it counts, unless the
  /// sensor observed another landmark next to it. @param observed landmarks
  bool countsAsMissed(size_t landmark, const std::vector<size_t>& observed) const;

  /// Whether missing a landmark makes a hypothesis less likely: as countsAsMissed(), by the positions of
  /// noteMisses().
  bool isUnlikelyMiss(size_t landmark, const std::vector<size_t>& observed) const;

  /// Notes that these landmarks were missed from here, whether it was evidence of their absence or not.
  void noteMisses(const std::vector<size_t>& missed, const std::vector<size_t>& observed);

  /// Whether a landmark was observed often enough to be certain that it exists.
  bool isEstablished(size_t landmark) const;

  /// Merges observed landmarks with others of the same label that are nearer than the minimum separation.
  /// @param observed indices @param separation metres
  /// @param keys of landmarks; that of a removed one is replaced by that of the landmark it was merged into
  /// @returns number of landmarks removed
  int mergeDuplicates(std::vector<size_t> observed, double separation, std::vector<std::optional<int>>& keys);

  /// Removes landmarks that probably do not exist. @returns their number
  int removeUnlikely();

  /// Removes the landmarks with this key and above.
  void removeFrom(int key);

  /// Replaces all landmarks; the new ones are certain to exist.
  /// @param covariance as LandmarkFilter::setState()
  /// @throws std::invalid_argument if the sizes of landmarks, labels and covariance differ
  void setMap(const Pose2& T_map_base, const std::vector<Landmark2D>& landmarks,
              const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance);

 private:
  std::optional<size_t> duplicateOf(size_t landmark, const std::vector<size_t>& observed,
                                    double separation) const;
  bool areDuplicates(size_t a, size_t b, double separation) const;
  bool isNewMiss(size_t landmark, const std::vector<size_t>& observed,
                 const std::optional<Eigen::Vector2d>& last) const;
  void remove(size_t landmark);  // from the filter, too
  void eraseEntry(size_t landmark);

  LandmarkFilter filter_;
  std::vector<LandmarkLabel> labels_;
  std::vector<int> keys_;
  struct Existence {
    double log_odds = 0;
    std::optional<Eigen::Vector2d> missed_from;  // position of the robot at the last miss that counted
    std::optional<Eigen::Vector2d> noted_from;   // at the last one that noteMisses() noted
  };
  std::vector<Existence> existence_;  // of each landmark
  int next_key_ = 0;
};

}  // namespace sextant
