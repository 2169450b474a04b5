// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>

#include "sextant/landmarks/landmark_sensor.hpp"

namespace sextant {

/// What a pose is computed from besides odometry.
enum class PoseSource {
  markers,    ///< sensors that detect only landmarks with an id
  landmarks,  ///< all other sensors of landmarks
  places,     ///< images whose place was recognized
};

constexpr size_t kPoseSources = 3;

/// The source of a scan.
PoseSource sourceOf(Detects detects);

/// Which sources one hypothesis about the pose takes to be wrong, for instance because their map is: their
/// scans are not applied. A source that contradicts the pose may be wrong only if another one supported it
/// shortly before; otherwise the pose is.
class SourceFaults {
 public:
  /// Logarithm of the probability that a source becomes wrong with a scan.
  static constexpr double kLogWrong = -7;

  /// Whether scans of a source are not applied.
  bool isExcluded(PoseSource source) const { return of(source).is_excluded; }
  /// Whether a source is excluded, and another one has confirmed it.
  bool isWrong(PoseSource source) const { return of(source).is_excluded && of(source).log_prior == 0; }
  /// Whether another source that is not excluded supported the pose within the last metres.
  bool mayBeWrong(PoseSource source) const;
  /// Takes a source to be wrong, unless it is already.
  void exclude(PoseSource source);

  /// Adds a scan or image of a source that supports the pose: it confirms that the others are wrong.
  void support(PoseSource source);
  /// Adds a scan of an excluded source. It is used again after a number of scans in a row that agree.
  /// @returns logarithm of the probability of a scan that contradicts the pose, while no other source has
  /// confirmed the exclusion
  double compare(PoseSource source, bool agrees);
  /// Moves the robot. An excluded source is used again if no other one supported the pose within the last
  /// metres. @param distance metres
  void drive(double distance);

  /// Logarithm of the probability of the exclusions that no other source has confirmed yet; at most 0.
  double logPrior() const;
  /// Uses the sources again whose exclusion no other source has confirmed.
  void forgetUnconfirmed();

  /// Whether the same sources are excluded.
  bool operator==(const SourceFaults& other) const;

 private:
  struct State {
    double unsupported = std::numeric_limits<double>::infinity();  // metres since it supported the pose
    bool is_excluded = false;
    int confirmations = 0;  // by other sources since it is excluded
    int agreeing = 0;       // of its scans, in a row
    double log_prior = 0;
  };
  State& of(PoseSource source) { return states_[static_cast<size_t>(source)]; }
  const State& of(PoseSource source) const { return states_[static_cast<size_t>(source)]; }

  std::array<State, kPoseSources> states_;  // in the order of PoseSource
};

}  // namespace sextant
