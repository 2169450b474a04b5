// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "sextant/localization/camera_errors.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {

/// A mapped marker in an image, linearized at the located pose.
struct MonitoredMarker {
  MarkerKey key;                                             ///< family and id
  size_t camera = 0;                                         ///< index of the camera
  std::array<double, 4> sigmas;                              ///< corner noise, pixels
  Matrix6d map_covariance = Matrix6d::Zero();                ///< of the map file; zero: exact
  MarkerLinearization linearization;                         ///< with the errors found so far removed
  Eigen::Matrix<double, 8, CameraErrors::kCount> by_camera;  ///< derivatives by the errors of its camera
};

/// A Gaussian prior of some of the errors; the other errors are certainly zero.
struct ErrorPrior {
  std::vector<Eigen::Index> columns;  ///< of ErrorSums; one may occur twice: the errors add up
  Eigen::MatrixXd covariance;         ///< of these columns

  /// Adds columns with independent errors. @param variances not zero
  void add(const std::vector<Eigen::Index>& added, const Eigen::VectorXd& variances);
};

/// Most probable errors, as a step from those that have been removed.
struct ErrorFit {
  double log_evidence;         ///< logarithm of the marginal likelihood, without constants
  double penalty;              ///< squared Mahalanobis distance of the errors in the prior
  Eigen::VectorXd step;        ///< of the columns of the prior
  Eigen::MatrixXd covariance;  ///< likewise
  double noise;                ///< variance of the whitened residuals
};

/// The linear least-squares problem in the errors of cameras, marker size and map that many images make up:
/// each error shifts the corners linearly, and the pose of each image is eliminated (Schur complement).
/// Residuals and derivatives are whitened by the corner noise; the errors are relative to values() that have
/// already been removed from the residuals.
class ErrorSums {
 public:
  static constexpr Eigen::Index kSize = 0;  ///< column of the logarithm of the marker size's factor

  /// Adds an image, or all images of one instant. @param weight below 1 if it is not independent of others
  void add(const std::vector<MonitoredMarker>& markers, double weight);

  /// First of the CameraErrors::kCount columns of each camera, by its index.
  const std::vector<Eigen::Index>& cameras() const { return cameras_; }
  /// First of the six columns of each marker: offset of its position and rotation, in the map's axes.
  const std::map<MarkerKey, Eigen::Index>& markers() const { return markers_; }
  /// Whether the images so far depend on an error.
  bool depend(Eigen::Index column) const { return H_(column, column) > 0; }
  Eigen::Index columns() const { return H_.rows(); }  ///< number of errors
  double count() const { return count_; }  ///< weighted number of residuals, minus that of the poses
  const Eigen::VectorXd& values() const { return values_; }  ///< errors that have been removed, by column

  /// Most probable errors, with an unknown variance of the noise. @param min_noise smallest variance
  ErrorFit fit(const ErrorPrior& prior, double min_noise = 1e-9) const;
  /// About what the logarithm of the evidence of a fit grows by with more columns.
  double gain(const ErrorPrior& prior, const ErrorFit& fit, const ErrorPrior& more) const;

  void remove(Eigen::Index column, double step);  ///< adds a step to an error that is removed
  void remove(const Eigen::VectorXd& step);       ///< the same for all columns
  /// Forgets a marker. @param variances of its six errors, which are integrated out; @param noise variance
  void eliminate(const MarkerKey& marker, const Vector6d& variances, double noise);
  void keepMarkers(size_t most);  ///< forgets those about which least is known
  void fade(double factor);       ///< weights all images so far
  void clear() { fade(0); }       ///< forgets all images, but not the errors that have been removed

 private:
  void grow(Eigen::Index count);
  void growFor(const std::vector<MonitoredMarker>& markers);
  void keep(const std::vector<Eigen::Index>& columns);
  void forget(const std::set<MarkerKey>& markers);
  Eigen::MatrixXd information(const std::vector<Eigen::Index>& rows,
                              const std::vector<Eigen::Index>& columns) const;
  static Eigen::VectorXd selected(const Eigen::VectorXd& all, const std::vector<Eigen::Index>& columns);

  std::vector<Eigen::Index> cameras_;
  std::map<MarkerKey, Eigen::Index> markers_;
  Eigen::MatrixXd H_;     // information, pose eliminated
  Eigen::VectorXd b_;     // and its right-hand side, relative to values_
  double squares_ = 0.0;  // weighted sum of squared residuals
  double count_ = 0.0;
  Eigen::VectorXd values_;
};

}  // namespace sextant
