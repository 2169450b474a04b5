// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <functional>
#include <map>
#include <stdexcept>

#include "sextant/base/range.hpp"
#include "sextant/landmarks/landmark_filter.hpp"

namespace sextant {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// The source work's: errors are differences.
class AdditiveFilter : public LandmarkFilter {
 public:
  explicit AdditiveFilter(const LandmarkFilterParams& params) : LandmarkFilter(params) {}
  std::unique_ptr<LandmarkFilter> clone() const override { return std::make_unique<AdditiveFilter>(*this); }

 private:
  Pose2 moved(const Pose2& pose, const Vector3d& xi) const override {
    return {pose.position + xi.head<2>(), wrapped(pose.heading + xi(2))};
  }
  PlaneLandmark moved(const PlaneLandmark& landmark, double, const VectorXd& xi) const override {
    PlaneLandmark result{landmark.position + xi.head<2>(), {}};
    if (landmark.heading) result.heading = wrapped(*landmark.heading + xi(2));
    return result;
  }
  VectorXd lever(const Vector2d&, int width) const override { return VectorXd::Zero(width); }

  void propagate(const Pose2& step) override {
    Indices known = poseIndices();
    if (scale_at_ >= 0) known.push_back(scale_at_);
    const Indices which = params_.sigma_points == "all" ? withAllOthers(known) : known;
    const Pose2 before = state_.pose;
    const MatrixXd L = factor(which);
    const UnscentedMoments moments = unscentedTransform(L, params_.points, [&](const VectorXd& xi) {
      const double scale = state_.scale + (scale_at_ >= 0 ? xi(3) : 0.0);
      VectorXd after = xi;
      after.head<2>() += before.position + scale * (rotation2(before.heading + xi(2)) * step.position);
      after(2) += step.heading;
      return after;
    });
    const Index changed = params_.sigma_points == "all" ? P_.size() : 3;
    state_.pose = {moments.mean.head<2>(), wrapped(before.heading + moments.mean(2))};
    MatrixXd columns = L.triangularView<Eigen::Lower>().solve(P_.columns(which).transpose()).transpose() *
                       moments.slopes.topRows(changed).transpose();
    const Indices replaced(which.begin(), which.begin() + changed);
    columns(replaced, Eigen::all) = moments.covariance.topLeftCorner(changed, changed);
    P_.setColumns(replaced, columns);
  }
};

/// Right-invariant on SE_{1+n}(2) (Barrau and Bonnabel 2015, "An EKF-SLAM algorithm with consistency
/// properties"): heading's error turns robot and landmarks together about the origin, so that what no
/// sighting can tell is not learned from errors of linearization.
class InvariantFilter : public LandmarkFilter {
 public:
  explicit InvariantFilter(const LandmarkFilterParams& params) : LandmarkFilter(params) {}
  std::unique_ptr<LandmarkFilter> clone() const override { return std::make_unique<InvariantFilter>(*this); }

 private:
  static Vector2d turned(const Vector2d& position, double xi_heading, const Vector2d& xi) {
    return rotation2(xi_heading) * position + leftJacobian2(xi_heading) * xi;
  }
  Pose2 moved(const Pose2& pose, const Vector3d& xi) const override {
    return {turned(pose.position, xi(2), xi.head<2>()), wrapped(pose.heading + xi(2))};
  }
  PlaneLandmark moved(const PlaneLandmark& landmark, double xi_heading, const VectorXd& xi) const override {
    PlaneLandmark result{turned(landmark.position, xi_heading, xi.head<2>()), {}};
    if (landmark.heading) result.heading = wrapped(*landmark.heading + xi_heading + xi(2));
    return result;
  }
  VectorXd lever(const Vector2d& position, int width) const override {
    VectorXd result = VectorXd::Ones(width);
    result.head<2>() = turnedLeft(position);
    return result;
  }

  // A step moves the state and leaves the error as it is; only its scale is felt.
  void propagate(const Pose2& step) override {
    const Vector2d way = rotation2(state_.pose.heading) * step.position;
    state_.pose = state_.pose * Pose2{state_.scale * step.position, step.heading};
    if (scale_at_ < 0) return;
    const Indices position{0, 1};
    MatrixXd columns = P_.columns(position);
    const VectorXd scale = P_.columns({scale_at_});
    const double variance = P_(scale_at_, scale_at_);
    columns += scale * way.transpose();
    columns.topRows<2>() += way * (scale.head<2>() + variance * way).transpose();
    P_.setColumns(position, columns);
  }
};

using Maker = std::function<std::unique_ptr<LandmarkFilter>(const LandmarkFilterParams&)>;

const std::map<std::string, Maker>& forms() {
  static const std::map<std::string, Maker> table{
      {"additive",
       [](const LandmarkFilterParams& params) { return std::make_unique<AdditiveFilter>(params); }},
      {"invariant",
       [](const LandmarkFilterParams& params) { return std::make_unique<InvariantFilter>(params); }}};
  return table;
}

}  // namespace

std::unique_ptr<LandmarkFilter> LandmarkFilter::make(const LandmarkFilterParams& params,
                                                     const Pose2& T_map_base, const Matrix3d& covariance) {
  params.validate();
  if (Eigen::LLT<Matrix3d>(covariance).info() != Eigen::Success)
    throw std::invalid_argument("the covariance of the first pose is not positive definite");
  auto filter = forms().at(params.form)(params);
  filter->setState(T_map_base, {}, covariance);
  return filter;
}

void LandmarkFilterParams::validate() const {
  requireOneOf("form", form, {"additive", "invariant"});
  requireOneOf("sigma_points", sigma_points, {"seen", "all"});
  requireOneOf("init", init, {"correlated", "independent"});
  points.validate();
  Range::closed(0, 1).require("scale_sigma", scale_sigma);
  Range::closed(0, 1).require("scale_drift", scale_drift);
  Range::closed(0, 10).require("clock_sigma", clock_sigma, "s");
}

}  // namespace sextant
