// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/geometry/camera.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

namespace sextant {
namespace {

constexpr double kMaxRadius = 20.0;  // on the normalized image plane: 87 degrees from the optical axis
constexpr int kLimitSteps = 2000;    // steps of the radius or angle in the search for its limit

[[noreturn]] void refuse(const std::string& what, double value, const std::string& allowed) {
  std::ostringstream text;
  text << "camera calibration: " << what << " is " << value << ", " << allowed;
  throw std::invalid_argument(text.str());
}

void requireFinite(const std::string& name, const double* values, Eigen::Index count) {
  for (Eigen::Index i = 0; i < count; ++i)
    if (!std::isfinite(values[i]))
      refuse(name + "[" + std::to_string(i) + "]", values[i], "but must be a finite number");
}

// Minimum focal length over the larger side of the image. Uncalibrated drivers publish a focal length of 0 or
// 1, which would be a wider view than any lens has.
constexpr double kMinRelativeFocalLength = 0.05;

void checkIntrinsics(const std::string& name, const Eigen::Matrix3d& K, int width, int height) {
  const double shortest = kMinRelativeFocalLength * std::max(width, height);
  for (int i = 0; i < 2; ++i) {
    const std::string f = name + (i == 0 ? " fx" : " fy");
    if (!(K(i, i) > shortest))
      refuse(f, K(i, i),
             "which is too short: calibrate the camera (must be > " + std::to_string(shortest) + " px)");
  }
  if (std::abs(K(0, 2)) > 2.0 * width + 1.0) refuse(name + " cx", K(0, 2), "which is far outside the image");
  if (std::abs(K(1, 2)) > 2.0 * height + 1.0) refuse(name + " cy", K(1, 2), "which is far outside the image");
}

// Allowed numbers of coefficients of each distortion model; plumb_bob without any has no distortion.
const std::map<std::string, std::vector<size_t>>& coefficientCounts() {
  static const std::map<std::string, std::vector<size_t>> counts = {
      {"plumb_bob", {0, 4, 5, 8}}, {"rational_polynomial", {8}}, {"equidistant", {4}}};
  return counts;
}

void checkDistortion(const CameraCalibration& calibration) {
  const auto entry = coefficientCounts().find(calibration.distortion_model);
  if (entry == coefficientCounts().end())
    throw std::invalid_argument("camera calibration: distortion_model is '" + calibration.distortion_model +
                                "', known are plumb_bob, rational_polynomial and equidistant");
  std::string allowed;
  for (const size_t count : entry->second) {
    if (calibration.D.size() == count) return;
    allowed += (allowed.empty() ? "" : ", ") + std::to_string(count);
  }
  throw std::invalid_argument("camera calibration: D has " + std::to_string(calibration.D.size()) +
                              " numbers, " + calibration.distortion_model + " has " + allowed);
}

}  // namespace

// A point on the distorted image plane, with its Jacobian with respect to the point in the camera frame.
struct CameraModel::Distorted {
  Eigen::Vector2d xy;
  Eigen::Matrix<double, 2, 3> jacobian;
};

CameraModel::CameraModel(const CameraCalibration& calibration, Image image)
    : width_(calibration.width), height_(calibration.height) {
  if (width_ < 1 || height_ < 1)
    throw std::invalid_argument("camera calibration: the image size is " + std::to_string(width_) + " x " +
                                std::to_string(height_) + ", is this camera calibrated?");
  const bool rectified = image == Image::rectified;
  const Eigen::Matrix3d K = rectified ? Eigen::Matrix3d(calibration.P.leftCols<3>()) : calibration.K;
  requireFinite(rectified ? "P" : "K", K.data(), K.size());
  checkIntrinsics(rectified ? "P" : "K", K, width_, height_);
  f_ = {K(0, 0), K(1, 1)};
  c_ = {K(0, 2), K(1, 2)};
  skew_ = K(0, 1);
  rectified ? setRectification(calibration.R) : setDistortion(calibration);
  setLimit();
}

CameraModel CameraModel::changed(double focal_factor, const Eigen::Vector2d& centre_step,
                                 double k1_step) const {
  CameraModel other = *this;
  other.f_ *= focal_factor;
  other.c_ += centre_step;
  other.d_[0] += k1_step;
  other.setLimit();
  return other;
}

void CameraModel::setRectification(const Eigen::Matrix3d& R) {
  requireFinite("R", R.data(), R.size());
  if (!(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0)
    throw std::invalid_argument("camera calibration: R is not a rotation, but rectified images need one");
  R_model_camera_ = Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

void CameraModel::setDistortion(const CameraCalibration& calibration) {
  checkDistortion(calibration);
  requireFinite("D", calibration.D.data(), static_cast<Eigen::Index>(calibration.D.size()));
  std::copy(calibration.D.begin(), calibration.D.end(), d_.begin());
  if (calibration.distortion_model == "equidistant") lens_ = Lens::equidistant;
}

// The radius at which r (1 + k1 r^2 + ...) / (1 + k4 r^2 + ...) stops rising: beyond it the projection is not
// unique.
double CameraModel::polynomialLimit() const {
  double last = 0.0;
  for (int i = 1; i <= kLimitSteps; ++i) {
    const double r = kMaxRadius * i / kLimitSteps;
    const double r2 = r * r;
    const double numerator = 1 + r2 * (d_[0] + r2 * (d_[1] + r2 * d_[4]));
    const double denominator = 1 + r2 * (d_[5] + r2 * (d_[6] + r2 * d_[7]));
    const double distorted = r * numerator / denominator;
    if (!(denominator > 0) || !(distorted > last)) return kMaxRadius * (i - 1) / kLimitSteps;
    last = distorted;
  }
  return kMaxRadius;
}

double CameraModel::equidistantLimit() const {
  double last = 0.0;
  for (int i = 1; i <= kLimitSteps; ++i) {
    const double theta = M_PI * i / kLimitSteps;
    const double distorted = distortAngle(theta);
    if (!(distorted > last)) return M_PI * (i - 1) / kLimitSteps;
    last = distorted;
  }
  return M_PI;
}

double CameraModel::distortAngle(double theta) const {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (d_[0] + t2 * (d_[1] + t2 * (d_[2] + t2 * d_[3]))));
}

double CameraModel::distortAngleDerivative(double theta) const {
  const double t2 = theta * theta;
  return 1 + t2 * (3 * d_[0] + t2 * (5 * d_[1] + t2 * (7 * d_[2] + t2 * 9 * d_[3])));
}

// OpenCV's calib3d, "Detailed description": radial and tangential distortion of the normalized plane.
CameraModel::PlaneDistortion CameraModel::distortPlane(const Eigen::Vector2d& xy) const {
  const double x = xy.x(), y = xy.y(), r2 = xy.squaredNorm();
  const double p1 = d_[2], p2 = d_[3];
  const double numerator = 1 + r2 * (d_[0] + r2 * (d_[1] + r2 * d_[4]));
  const double denominator = 1 + r2 * (d_[5] + r2 * (d_[6] + r2 * d_[7]));
  const double radial = numerator / denominator;
  const double numerator_dr2 = d_[0] + r2 * (2 * d_[1] + r2 * 3 * d_[4]);
  const double denominator_dr2 = d_[5] + r2 * (2 * d_[6] + r2 * 3 * d_[7]);
  const double radial_dr2 = (numerator_dr2 - radial * denominator_dr2) / denominator;
  PlaneDistortion out;
  out.xy << x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
      y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  out.jacobian << radial + 2 * x * x * radial_dr2 + 2 * p1 * y + 6 * p2 * x,
      2 * x * y * radial_dr2 + 2 * p1 * x + 2 * p2 * y,  //
      2 * x * y * radial_dr2 + 2 * p1 * x + 2 * p2 * y,
      radial + 2 * y * y * radial_dr2 + 6 * p1 * y + 2 * p2 * x;
  return out;
}

std::optional<CameraModel::Distorted> CameraModel::distortPolynomial(const Eigen::Vector3d& p) const {
  if (!(p.z() > 0)) return std::nullopt;
  const Eigen::Vector2d xy = p.head<2>() / p.z();
  if (xy.squaredNorm() > limit_ * limit_) return std::nullopt;
  const PlaneDistortion plane = distortPlane(xy);
  Eigen::Matrix<double, 2, 3> xy_dp;
  xy_dp << 1, 0, -xy.x(), 0, 1, -xy.y();
  return Distorted{plane.xy, plane.jacobian * xy_dp / p.z()};
}

// Kannala & Brandt 2006, as in OpenCV's fisheye module: theta_d(theta) along the direction of (x, y).
std::optional<CameraModel::Distorted> CameraModel::distortEquidistant(const Eigen::Vector3d& p) const {
  const double rho = p.head<2>().norm();
  const double theta = std::atan2(rho, p.z());
  if (theta > limit_ || (rho == 0 && p.z() <= 0)) return std::nullopt;
  const double norm2 = p.squaredNorm();
  if (rho < 1e-9 * p.z()) {
    Distorted out{p.head<2>() / p.z(), Eigen::Matrix<double, 2, 3>::Zero()};
    out.jacobian.leftCols<2>().diagonal().setConstant(1 / p.z());
    return out;
  }
  const Eigen::Vector2d direction = p.head<2>() / rho;
  const double theta_d = distortAngle(theta);
  Eigen::RowVector3d theta_dp;
  theta_dp << direction.transpose() * p.z() / norm2, -rho / norm2;
  Distorted out{theta_d * direction, direction * distortAngleDerivative(theta) * theta_dp};
  out.jacobian.leftCols<2>() +=
      theta_d / rho * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
  return out;
}

std::optional<Projection> CameraModel::projectWithJacobian(const Eigen::Vector3d& p_camera) const {
  const Eigen::Vector3d p = R_model_camera_ * p_camera;
  const auto distorted = lens_ == Lens::equidistant ? distortEquidistant(p) : distortPolynomial(p);
  if (!distorted) return std::nullopt;
  Eigen::Matrix2d A;
  A << f_.x(), skew_, 0, f_.y();
  return Projection{A * distorted->xy + c_, A * distorted->jacobian * R_model_camera_};
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_camera) const {
  const auto projection = projectWithJacobian(p_camera);
  if (!projection) return std::nullopt;
  return projection->pixel;
}

// Newton's method on the normalized plane, started from the distorted point.
std::optional<Eigen::Vector3d> CameraModel::undistortPolynomial(const Eigen::Vector2d& distorted) const {
  Eigen::Vector2d xy = distorted;
  for (int i = 0; i < 30; ++i) {
    if (!(xy.squaredNorm() <= limit_ * limit_)) xy *= 0.9 * limit_ / xy.norm();
    const PlaneDistortion plane = distortPlane(xy);
    const Eigen::Vector2d error = distorted - plane.xy;
    if (error.squaredNorm() < 1e-24) return xy.homogeneous();
    xy += plane.jacobian.inverse() * error;
    if (!xy.allFinite()) return std::nullopt;
  }
  const bool solved = (distorted - distortPlane(xy).xy).norm() < 1e-9 && xy.norm() <= limit_;
  return solved ? std::optional<Eigen::Vector3d>(xy.homogeneous()) : std::nullopt;
}

std::optional<Eigen::Vector3d> CameraModel::undistortEquidistant(const Eigen::Vector2d& distorted) const {
  const double theta_d = distorted.norm();
  if (theta_d < 1e-12) return Eigen::Vector3d::UnitZ();
  if (theta_d > distortAngle(limit_)) return std::nullopt;
  double low = 0, high = limit_, theta = std::min(theta_d, limit_);
  for (int i = 0; i < 60 && high - low > 1e-14; ++i) {  // Newton's method, with bisection as a safeguard
    const double error = theta_d - distortAngle(theta);
    (error > 0 ? low : high) = theta;
    if (std::abs(error) < 1e-14) break;
    const double next = theta + error / distortAngleDerivative(theta);
    theta = next > low && next < high ? next : 0.5 * (low + high);
  }
  const Eigen::Vector2d direction = distorted / theta_d;
  return Eigen::Vector3d(std::sin(theta) * direction.x(), std::sin(theta) * direction.y(), std::cos(theta));
}

Eigen::Vector2d CameraModel::derivativeByFirstCoefficient(const Eigen::Vector2d& pixel) const {
  const auto ray = unproject(pixel);
  if (!ray) return Eigen::Vector2d::Zero();
  const Eigen::Vector3d p = R_model_camera_ * *ray;
  const double rho = p.head<2>().norm();
  if (lens_ == Lens::equidistant)
    return rho > 0 ? Eigen::Vector2d(f_.cwiseProduct(p.head<2>()) / rho * std::pow(std::atan2(rho, p.z()), 3))
                   : Eigen::Vector2d::Zero();
  const Eigen::Vector2d xy = p.head<2>() / p.z();
  const double r2 = xy.squaredNorm(), denominator = 1 + r2 * (d_[5] + r2 * (d_[6] + r2 * d_[7]));
  return f_.cwiseProduct(xy) * (r2 / denominator);
}

std::optional<Eigen::Vector3d> CameraModel::unproject(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const double y = (pixel.y() - c_.y()) / f_.y();
  const Eigen::Vector2d distorted((pixel.x() - c_.x() - skew_ * y) / f_.x(), y);
  const auto ray =
      lens_ == Lens::equidistant ? undistortEquidistant(distorted) : undistortPolynomial(distorted);
  if (!ray) return std::nullopt;
  return R_model_camera_.transpose() * ray->normalized();
}

}  // namespace sextant
