// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_correction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sextant/localization/mapped_observation.hpp"

namespace sextant {
namespace {

constexpr double kMaxStep = 0.5;      // seconds between two images whose difference is a velocity
constexpr double kSameView = 5.0;     // pixels (RMS) by which the corners move within one view
constexpr Eigen::Index kShutter = 4;  // column of CameraErrors::vector()
constexpr size_t kReplayed = 300;     // markers in the images that replay() locates again: some 50 ms

const Detection* findDetection(const MarkerView& view, const MarkerKey& key) {
  const auto found = std::find_if(view.detections.begin(), view.detections.end(),
                                  [&](const Detection& detection) { return detection.key == key; });
  return found == view.detections.end() ? nullptr : &*found;
}

std::vector<MonitoredMarker> monitoredMarkers(const MarkerMap& file, const MarkerMap& corrected,
                                              const std::vector<MarkerView>& views, double corner_sigma,
                                              const std::set<MarkerKey>& ignored, const LocatedPose& pose) {
  std::vector<MonitoredMarker> all;
  for (const LocatedMarker& located : pose.markers)
    for (const MarkerView& view : views) {
      if (ignored.count(located.key) > 0) continue;
      const Detection* detection =
          view.camera_index == located.camera_index ? findDetection(view, located.key) : nullptr;
      const MappedMarker* mapped = corrected.find(located.key);
      if (!detection || !mapped) continue;
      const auto observation = mappedObservation(view, *detection, *mapped, corner_sigma);
      const auto linear = linearizedMarker(observation, pose.T_map_base);
      if (!linear) continue;
      MonitoredMarker marker{
          located.key, view.camera_index, observation.sigmas, file.find(located.key)->covariance, *linear,
          {}};
      for (int k = 0; k < 4; ++k)
        marker.by_camera.middleRows<2>(2 * k) = cameraErrorJacobian(view.camera, detection->corners[k]);
      all.push_back(marker);
    }
  return all;
}

// The rows' times over the readout time.
Eigen::Matrix<double, 8, 1> rowTimes(const MonitoredMarker& marker, const std::vector<MarkerView>& views) {
  Eigen::Matrix<double, 8, 1> times = Eigen::Matrix<double, 8, 1>::Zero();
  for (const MarkerView& view : views)
    if (const Detection* detection =
            view.camera_index == marker.camera ? findDetection(view, marker.key) : nullptr)
      for (int i = 0; i < 8; ++i) times[i] = rowTime(view.camera, detection->corners[i / 2].y());
  return times;
}

}  // namespace

CameraErrors ErrorCorrection::errorsOf(size_t camera) const {
  CameraErrors errors = monitor_.cameraErrors(camera);
  errors.readout_time += readout_time_;
  return errors;
}

bool ErrorCorrection::needsMotion() const {
  if (readout_time_ > 0) return true;
  for (const SystematicError& error : monitor_.errors())
    if (error.cause == ErrorCause::shutter) return true;
  return false;
}

// With the velocities u and v over the last two steps of about equal time, that at the end is v + (v - u)
// / 2.
std::optional<Motion> ErrorCorrection::motion(std::optional<double> stamp,
                                              const std::optional<Pose>& T_map_base) const {
  if (!stamp || !last_ || !last_->stamp || *stamp - *last_->stamp > kMaxStep) return std::nullopt;
  const auto before = before_ ? velocity(*before_, *last_) : std::nullopt;
  if (!T_map_base) {
    if (!before) return std::nullopt;
    return Motion{perturbed(last_->T_map_base, *before * (*stamp - *last_->stamp)), *before,
                  Vector6d::Zero()};
  }
  const auto after = velocity(*last_, Instant{{}, {}, *T_map_base, stamp, 0, {}});
  if (!after) return std::nullopt;
  const Vector6d change = before ? Vector6d(0.5 * (*after - *before)) : Vector6d::Zero();
  return Motion{*T_map_base, *after + change, change};
}

std::vector<MarkerView> ErrorCorrection::corrected(const MarkerMap& map, std::vector<MarkerView> views,
                                                   const std::optional<Motion>& motion) const {
  for (MarkerView& view : views) {
    const CameraErrors errors = errorsOf(view.camera_index);
    if (errors.areZero()) continue;
    view.camera = withErrors(view.camera, errors);
    if (errors.readout_time == 0 || !motion) continue;
    for (Detection& detection : view.detections) {
      const MappedMarker* mapped = map.find(detection.key);
      const auto linear =
          mapped ? linearizedMarker(mappedObservation(view, detection, *mapped, 1.0), motion->T_map_base)
                 : std::nullopt;
      if (!linear) continue;
      const Eigen::Matrix<double, 8, 1> speed = linear->by_base * motion->velocity;  // pixels per second
      for (int k = 0; k < 4; ++k)
        detection.corners[k] -=
            errors.readout_time * rowTime(view.camera, detection.corners[k].y()) * speed.segment<2>(2 * k);
    }
  }
  return views;
}

MarkerMap ErrorCorrection::corrected(const MarkerMap& map, const std::vector<MarkerView>& views) const {
  MarkerMap result(map.frame());
  for (const MarkerView& view : views)
    for (const Detection& detection : view.detections)
      if (const MappedMarker* mapped = map.find(detection.key)) result.set(monitor_.corrected(*mapped));
  return result;
}

void ErrorCorrection::add(const MarkerMap& map, const Images& images, double corner_sigma,
                          const std::set<MarkerKey>& ignored, LocatedPose& pose) {
  const auto& views = images.views;
  auto markers = monitoredMarkers(map, images.corrected_map, images.corrected, corner_sigma, ignored, pose);
  for (MonitoredMarker& marker : markers) marker.by_camera.col(kShutter) = rowTimes(marker, views);
  addCovariance(markers, images.motion, pose);
  Instant now{views, markers, pose.T_map_base, images.stamp, weightOf(markers, views), {}};
  if (last_) {
    last_->velocity = velocity(before_ ? *before_ : *last_, now);
    finish(*last_);
    before_ = std::exchange(last_, std::nullopt);
    keep(*before_);
  }
  last_ = std::move(now);
}

void ErrorCorrection::replay(const MarkerMap& map, double corner_sigma, const std::set<MarkerKey>& ignored,
                             const Locate& locate) {
  if (!monitor_.needsReplay()) return;
  monitor_.beginReplay();
  for (Instant& instant : recent_) {
    std::optional<Motion> motion;
    if (instant.velocity) motion = Motion{instant.T_map_base, *instant.velocity, Vector6d::Zero()};
    auto views = corrected(map, instant.views, motion);
    const MarkerMap corrected_map = corrected(map, views);
    LocatorResult result = locate(corrected_map, views);
    const auto& pose = result.pose ? result.pose : result.rejected;
    if (!pose) continue;
    instant.markers = monitoredMarkers(map, corrected_map, views, corner_sigma, ignored, *pose);
    for (MonitoredMarker& marker : instant.markers) marker.by_camera.col(kShutter) = rowTimes(marker, views);
    instant.T_map_base = pose->T_map_base;
    finish(instant);
  }
  monitor_.evaluate();
}

// Images of a view that is in recent_ already contain no more about the errors.
void ErrorCorrection::keep(Instant instant) {
  if (instant.weight < 1 || instant.markers.size() < 2) return;
  recent_.push_back(std::move(instant));
  size_t markers = 0;
  for (const Instant& each : recent_) markers += each.markers.size();
  while (markers > kReplayed) {
    markers -= recent_.front().markers.size();
    recent_.pop_front();
  }
}

void ErrorCorrection::addCovariance(const std::vector<MonitoredMarker>& markers,
                                    const std::optional<Motion>& motion, LocatedPose& pose) const {
  std::vector<MonitoredMarker> used;
  Matrix6d information = Matrix6d::Zero();
  for (const MonitoredMarker& marker : markers)
    for (const LocatedMarker& located : pose.markers) {
      if (!located.used || !(located.key == marker.key) || located.camera_index != marker.camera) continue;
      used.push_back(marker);
      const MarkerLinearization& linear = marker.linearization;
      information += linear.by_base.transpose() * linear.covariance.ldlt().solve(linear.by_base);
    }
  if (used.empty()) return;
  // The rows' times remain in the column of the shutter; a column of derivatives needs the velocity, too.
  Vector6d by_velocity_error = Vector6d::Zero(), by_stamp = Vector6d::Zero();
  for (MonitoredMarker& marker : used) {
    const Eigen::Matrix<double, 8, 1> times = marker.by_camera.col(kShutter);
    const double readout = errorsOf(marker.camera).readout_time;
    const auto speed = [&](const Vector6d& velocity) {
      return Eigen::Matrix<double, 8, 1>(times.cwiseProduct(marker.linearization.by_base * velocity));
    };
    const MarkerLinearization& linear = marker.linearization;
    if (motion) {
      by_velocity_error +=
          information.ldlt().solve(linear.by_base.transpose() *
                                   linear.covariance.ldlt().solve(readout * speed(motion->velocity_error)));
      by_stamp = 0.5 * readout * motion->velocity;
    }
    marker.by_camera.col(kShutter) =
        motion ? speed(motion->velocity) : Eigen::Matrix<double, 8, 1>(Eigen::Matrix<double, 8, 1>::Zero());
  }
  pose.covariance += monitor_.poseCovariance(used, information) +
                     by_velocity_error * by_velocity_error.transpose() + by_stamp * by_stamp.transpose();
}

void ErrorCorrection::finish(Instant instant) {
  for (MonitoredMarker& marker : instant.markers) {
    if (!instant.velocity) {
      marker.by_camera.col(kShutter).setZero();
      continue;
    }
    const Eigen::Matrix<double, 8, 1> speed = marker.linearization.by_base * *instant.velocity;
    marker.by_camera.col(kShutter) = marker.by_camera.col(kShutter).cwiseProduct(speed).eval();
  }
  monitor_.add(instant.markers, instant.weight);
}

std::optional<Vector6d> ErrorCorrection::velocity(const Instant& before, const Instant& after) {
  if (!before.stamp || !after.stamp) return std::nullopt;
  const double step = *after.stamp - *before.stamp;
  if (!(step > 0) || step > 2 * kMaxStep) return std::nullopt;
  return Vector6d(poseError(after.T_map_base, before.T_map_base) / step);
}

// The images of one view have the same systematic errors of the corners: together they count as the logarithm
// of their number.
double ErrorCorrection::weightOf(const std::vector<MonitoredMarker>& markers,
                                 const std::vector<MarkerView>& views) {
  double squares = 0;
  int count = 0;
  std::map<MarkerKey, Corners> corners;
  for (const MonitoredMarker& marker : markers)
    for (const MarkerView& view : views)
      if (const Detection* detection =
              view.camera_index == marker.camera ? findDetection(view, marker.key) : nullptr) {
        corners[marker.key] = detection->corners;
        const auto earlier = anchor_.find(marker.key);
        if (earlier == anchor_.end()) continue;
        squares += (centre(detection->corners) - centre(earlier->second)).squaredNorm();
        ++count;
      }
  if (count > 0 && corners.size() == anchor_.size() && squares < kSameView * kSameView * count)
    return 1.0 / (1 + ++repetitions_);
  anchor_ = corners;
  repetitions_ = 0;
  return 1.0;
}

void ErrorCorrection::reset() { *this = ErrorCorrection(readout_time_); }

}  // namespace sextant
