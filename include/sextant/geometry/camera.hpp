// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace sextant {

/// Intrinsic calibration in the fields and conventions of sensor_msgs/CameraInfo, for the image as published:
/// binning and region of interest are already applied to width, height, K and P.
struct CameraCalibration {
  int width = 0;                                    ///< pixels
  int height = 0;                                   ///< pixels
  std::string distortion_model;                     ///< plumb_bob, rational_polynomial or equidistant
  std::vector<double> D;                            ///< distortion coefficients in OpenCV's order
  Eigen::Matrix3d K = Eigen::Matrix3d::Zero();      ///< camera matrix of the raw image, pixels
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< rectification rotation
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();  ///< projection of the rectified image
};

/// A pixel and its Jacobian with respect to the point in the camera frame.
struct Projection {
  Eigen::Vector2d pixel;                 ///< pixels
  Eigen::Matrix<double, 2, 3> jacobian;  ///< pixels per metre
};

/// Projection of a calibrated camera with lens distortion, from the optical frame (z forward, x right, y
/// down, metres) to pixels. (0, 0) is the centre of the first pixel. The optical frame is always that of the
/// raw image, so the raw and the rectified image of a camera give the same pose.
///
/// Formulas: OpenCV's calib3d (plumb_bob, rational_polynomial) and its fisheye module (equidistant,
/// Kannala-Brandt).
class CameraModel {
 public:
  /// Image in which pixels are measured.
  enum class Image { raw, rectified };

  /// @throws std::invalid_argument with the field, its value and the allowed values
  CameraModel(const CameraCalibration& calibration, Image image);

  int width() const { return width_; }    ///< pixels
  int height() const { return height_; }  ///< pixels
  /// Focal length in pixels, the mean of both axes.
  double focalLength() const { return 0.5 * (f_.x() + f_.y()); }
  Eigen::Vector2d principalPoint() const { return c_; }  ///< pixels

  /// Projects a point in the optical frame to a pixel, which may lie outside the image. Returns nothing
  /// beyond the radius (or angle, equidistant) at which the distortion polynomial stops rising, and, except
  /// for the equidistant model, for a point behind the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_camera) const;
  /// Projects as project(), and computes the Jacobian.
  std::optional<Projection> projectWithJacobian(const Eigen::Vector3d& p_camera) const;

  /// Derivative of a pixel with respect to the lens's first coefficient (k1), pixels; zero where unproject()
  /// has no result.
  Eigen::Vector2d derivativeByFirstCoefficient(const Eigen::Vector2d& pixel) const;

  /// Returns a camera whose focal length is longer by a factor, with its principal point (pixels) and first
  /// coefficient changed.
  CameraModel changed(double focal_factor, const Eigen::Vector2d& centre_step, double k1_step) const;

  /// Returns the unit vector in the optical frame toward a pixel, or nothing if the lens model has no inverse
  /// there.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;

 private:
  enum class Lens { polynomial, equidistant };
  struct Distorted;
  struct PlaneDistortion {
    Eigen::Vector2d xy;
    Eigen::Matrix2d jacobian;
  };
  void setLimit() { limit_ = lens_ == Lens::equidistant ? equidistantLimit() : polynomialLimit(); }
  void setRectification(const Eigen::Matrix3d& R);
  void setDistortion(const CameraCalibration& calibration);
  double polynomialLimit() const;
  double equidistantLimit() const;
  double distortAngle(double theta) const;
  double distortAngleDerivative(double theta) const;
  PlaneDistortion distortPlane(const Eigen::Vector2d& xy) const;
  std::optional<Distorted> distortPolynomial(const Eigen::Vector3d& p) const;
  std::optional<Distorted> distortEquidistant(const Eigen::Vector3d& p) const;
  std::optional<Eigen::Vector3d> undistortPolynomial(const Eigen::Vector2d& distorted) const;
  std::optional<Eigen::Vector3d> undistortEquidistant(const Eigen::Vector2d& distorted) const;

  int width_;
  int height_;
  Lens lens_ = Lens::polynomial;
  std::array<double, 8> d_{};  // k1 k2 p1 p2 k3 k4 k5 k6, or k1 k2 k3 k4 of the equidistant model
  Eigen::Vector2d f_;          // pixels
  Eigen::Vector2d c_;          // pixels
  double skew_ = 0.0;          // K(0, 1)
  Eigen::Matrix3d R_model_camera_ = Eigen::Matrix3d::Identity();  // rectification; identity for a raw image
  double limit_ = 0.0;  // largest radius (polynomial) or angle (equidistant) on the rising branch
};

}  // namespace sextant
