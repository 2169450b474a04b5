// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "sextant/markers/reprojection.hpp"

namespace sextant {
namespace {

constexpr double kMinArea = 4.0;        // pixels^2; a smaller quadrilateral is degenerate
constexpr double kSamePosition = 1e-4;  // fraction of the distance; closer solutions are the same minimum
constexpr double kSameRotation = 1e-3;  // radians, likewise

bool isConvex(const Corners& corners) {
  double area = 0.0, smallest = 1e18;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i],
                          b = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    const double cross = a.x() * b.y() - a.y() * b.x();  // positive: clockwise in the image, whose y is down
    smallest = std::min(smallest, cross);
    area += 0.25 * cross;
  }
  return smallest > 0 && area > kMinArea;
}

std::optional<std::array<Eigen::Vector3d, 4>> raysTo(const CameraModel& camera, const Corners& corners) {
  std::array<Eigen::Vector3d, 4> rays;
  for (int i = 0; i < 4; ++i) {
    const auto ray = camera.unproject(corners[i]);
    if (!ray) return std::nullopt;
    rays[i] = *ray;
  }
  return rays;
}

// Returns the rotation to a virtual camera whose optical axis points at the marker, so that rays of wide
// lenses also intersect the plane z = 1.
std::optional<Eigen::Matrix3d> towardMarker(const std::array<Eigen::Vector3d, 4>& rays) {
  const Eigen::Vector3d middle = rays[0] + rays[1] + rays[2] + rays[3];
  const auto R = Eigen::Quaterniond::FromTwoVectors(middle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const Eigen::Vector3d& ray : rays)
    if ((R * ray).z() < 0.05) return std::nullopt;
  return R;
}

std::vector<Pose> ippe(const std::array<Eigen::Vector3d, 4>& rays, const Eigen::Matrix3d& R, double size) {
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> plane;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d c = markerCorners(size)[i], ray = R * rays[i];
    object.emplace_back(c.x(), c.y(), c.z());
    plane.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solvePnPGeneric(object, plane, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                      cv::SOLVEPNP_IPPE_SQUARE);
  std::vector<Pose> poses;
  for (size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Vector3d r(rotations[i].ptr<double>()), t(translations[i].ptr<double>());
    Pose pose = Pose::Identity();
    pose.linear() = R.transpose() * expSO3(r);
    pose.translation() = R.transpose() * t;
    if (isFinite(pose)) poses.push_back(pose);
  }
  return poses;
}

// Minimizes over T_marker_camera and returns T_camera_marker; nothing for a marker behind the camera.
std::optional<MarkerPose> refined(const CameraModel& camera, const Corners& corners, double size,
                                  const Pose& start) {
  const auto fit = minimizeReprojection({{&camera, Pose::Identity(), Pose::Identity(), size, corners}},
                                        start.inverse(), {});
  if (!fit || fit->T_map_base.translation().z() <= 0) return std::nullopt;
  return MarkerPose{fit->T_map_base.inverse(), fit->rms};
}

bool same(const Pose& a, const Pose& b) {
  const Vector6d difference = poseError(a, b);
  return difference.head<3>().norm() < kSamePosition * a.translation().norm() &&
         difference.tail<3>().norm() < kSameRotation;
}

// Returns the distinct minima, the best first.
std::vector<MarkerPose> localMinima(const CameraModel& camera, const Corners& corners, double size,
                                    const std::vector<Pose>& starts) {
  std::vector<MarkerPose> minima;
  for (const Pose& start : starts) {
    const auto solution = refined(camera, corners, size, start);
    if (solution && (minima.empty() || !same(minima[0].T_camera_marker, solution->T_camera_marker)))
      minima.push_back(*solution);
  }
  std::sort(minima.begin(), minima.end(), [](const MarkerPose& a, const MarkerPose& b) {
    return a.reprojection_error < b.reprojection_error;
  });
  return minima;
}

}  // namespace

double PlanarPoses::ambiguity() const {
  if (!alternative) return 0.0;
  return alternative->reprojection_error > 0 ? best.reprojection_error / alternative->reprojection_error
                                             : 1.0;
}

std::optional<PlanarPoses> solveMarkerPose(const CameraModel& camera, const Corners& corners, double size) {
  if (!(size > 0) || !isConvex(corners)) return std::nullopt;
  const auto rays = raysTo(camera, corners);
  const auto R = rays ? towardMarker(*rays) : std::nullopt;
  if (!R) return std::nullopt;
  auto minima = localMinima(camera, corners, size, ippe(*rays, *R, size));
  if (minima.empty()) return std::nullopt;
  PlanarPoses both{minima[0], std::nullopt};
  if (minima.size() > 1) both.alternative = minima[1];
  return both;
}

std::optional<Matrix6d> markerPoseCovariance(const CameraModel& camera, const Pose& T_camera_marker,
                                             double size, double sigma) {
  Matrix6d information = Matrix6d::Zero();
  for (const Eigen::Vector3d& corner : markerCorners(size)) {
    const Eigen::Vector3d arm = T_camera_marker.linear() * corner;
    const auto projection = camera.projectWithJacobian(arm + T_camera_marker.translation());
    if (!projection) return std::nullopt;
    Eigen::Matrix<double, 2, 6> J;
    J << projection->jacobian, -projection->jacobian * skew(arm);
    information += J.transpose() * J / (sigma * sigma);
  }
  const Eigen::LLT<Matrix6d> cholesky(information);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Matrix6d covariance = cholesky.solve(Matrix6d::Identity());
  if (!covariance.allFinite()) return std::nullopt;
  return Matrix6d(0.5 * (covariance + covariance.transpose()));  // exactly symmetric
}

}  // namespace sextant
