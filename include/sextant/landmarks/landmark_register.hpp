// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_matching.hpp"

namespace sextant {

/// The landmarks of a filter, with what the filter does not know of them: what they are, and how surely they
/// are there.
class LandmarkRegister {
 public:
  /// @throws std::invalid_argument as LandmarkFilter's constructor
  LandmarkRegister(const LandmarkFilterParams& params, const Pose2& T_map_base,
                   const Eigen::Matrix3d& covariance)
      : filter_(params, T_map_base, covariance) {}

  const LandmarkFilter& filter() const { return filter_; }
  LandmarkFilter& filter() { return filter_; }
  const std::vector<LandmarkLabel>& labels() const { return labels_; }
  const std::vector<int>& keys() const { return keys_; }  ///< a number of each, the same as long as it lives
  int nextKey() const { return next_key_; }
  std::optional<size_t> find(const LandmarkLabel& label) const;  ///< the first of this label
  std::vector<MapPoint> points() const;

  void add(const LabelledSighting& sighting);

  /// Log odds that a landmark is there: more for one that is seen or missed. Sure ones do not get surer.
  void judge(const std::vector<size_t>& landmarks, double evidence);

  /// Makes those that are seen now one with others of their label that surely are nearer than two can be.
  /// @param told keys, in which those that are gone become those of the ones that they are
  /// @returns how many are gone
  int mergeSame(std::vector<size_t> seen, double separation, std::vector<std::optional<int>>& told);

  /// @returns how many are gone
  int removeDoubted();

  /// Those of this key and above.
  void removeFrom(int key);

  /// A map from elsewhere, of which all is sure. @param covariance as LandmarkFilter::setState()
  /// @throws std::invalid_argument where numbers of landmarks, labels and rows do not fit
  void setMap(const Pose2& T_map_base, const std::vector<PlaneLandmark>& landmarks,
              const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance);

 private:
  bool areOne(size_t a, size_t b, double separation) const;
  void remove(size_t landmark);
  void forget(size_t landmark);

  LandmarkFilter filter_;
  std::vector<LandmarkLabel> labels_;
  std::vector<int> keys_;
  std::vector<double> standing_;
  int next_key_ = 0;
};

}  // namespace sextant
