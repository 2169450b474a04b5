// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/map_adjustment.hpp"

#include <ceres/crs_matrix.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <set>

#include "adjustment_costs.hpp"
#include "map_information.hpp"
#include "pose_manifold.hpp"

namespace sextant {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kRobustOdometry = 4.0;  // width of the odometry's robust loss, against slipping wheels
// Minimum standard deviations of an odometry step, for a robot at rest.
constexpr double kStandingPosition = 5e-4;  // metres
constexpr double kStandingAngle = 5e-4;     // radians
constexpr double kExtraSigma =
    1e-6;  // metres or radians, added to known markers: their covariance may be singular

// The odometry step from one instant to another; nothing if odometry has a gap.
std::optional<PosePrior> odometryBetween(const MarkerRecording& recording, size_t from, size_t to,
                                         const OdometryParams& params) {
  Matrix6d standing = Matrix6d::Zero();
  standing.diagonal() << Eigen::Vector3d::Constant(kStandingPosition * kStandingPosition),
      Eigen::Vector3d::Constant(kStandingAngle * kStandingAngle);
  PosePrior step{Pose::Identity(), standing};
  if (recording[from].drive != recording[to].drive) return std::nullopt;
  for (size_t i = from; i < to; ++i) {
    const auto &a = recording[i].T_odom_base, &b = recording[i + 1].T_odom_base;
    if (!a || !b) return std::nullopt;
    step = movedByOdometry(step, a->inverse() * *b, params);
  }
  return step;
}

class AdjustmentProblem {
 public:
  AdjustmentProblem(const MarkerRecording& recording, const std::vector<RecordedObservation>& used,
                    const MarkerMap& known, const MapEstimate& estimate, const AdjustmentParams& params)
      : recording_(recording), params_(params), problem_(options()) {
    for (const RecordedObservation& observation : used) addObservation(observation, estimate);
    for (const auto& entry : known.markers()) addKnown(entry.second);
    addOdometry();
    if (params_.floor) addFloor();
    addLensPriors();
  }

  bool solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_SCHUR;
    options.max_num_iterations = kMaxIterations;
    options.num_threads = params_.threads;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary.IsSolutionUsable();
  }

  void write(MapEstimate& estimate) const {
    for (const auto& [key, block] : markers_) {
      MappedMarker marker = *estimate.map.find(key);
      marker.T_map_marker = poseFromBlock(block);
      estimate.map.set(marker);
    }
    for (const auto& [instant, block] : bases_) estimate.T_map_base[instant] = poseFromBlock(block);
    for (const auto& [camera, lens] : lenses_) estimate.lenses[camera] = lens;
  }

  std::optional<Eigen::MatrixXd> covariance(const MarkerMap& map) {
    ceres::Problem::EvaluateOptions options;
    options.num_threads = params_.threads;
    for (auto& entry : bases_) options.parameter_blocks.push_back(entry.second.data());
    for (auto& [key, block] : markers_)
      if (held_.count(key) == 0) options.parameter_blocks.push_back(block.data());
    if (params_.lens_sigma > 0)
      for (auto& entry : lenses_) options.parameter_blocks.push_back(entry.second.data());
    ceres::CRSMatrix jacobian;
    if (!problem_.Evaluate(options, nullptr, nullptr, nullptr, &jacobian)) return std::nullopt;
    const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> sparse(
        jacobian.num_rows, jacobian.num_cols, static_cast<Eigen::Index>(jacobian.values.size()),
        jacobian.rows.data(), jacobian.cols.data(), jacobian.values.data());
    const auto found = mapParameterCovariance(sparse, static_cast<Eigen::Index>(bases_.size()));
    if (!found) return std::nullopt;
    return ofMarkers(*found, map);
  }

 private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    keepManifolds(options);
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  double* add(PoseBlock& block) {
    problem_.AddParameterBlock(block.data(), 7, &manifold_);
    return block.data();
  }

  template <typename Blocks, typename Key>
  double* blockOf(Blocks& blocks, const Key& key, const Pose& pose) {
    const auto found = blocks.find(key);
    if (found != blocks.end()) return found->second.data();
    return add(blocks.emplace(key, blockFromPose(pose)).first->second);
  }

  void addObservation(const RecordedObservation& observation, const MapEstimate& estimate) {
    const MarkerView& view = recording_[observation.instant].views[observation.view];
    const Detection& detection = view.detections[observation.detection];
    const MappedMarker& marker = *estimate.map.find(detection.key);
    double* base = blockOf(bases_, observation.instant, *estimate.T_map_base[observation.instant]);
    double* marker_pose = blockOf(markers_, detection.key, marker.T_map_marker);
    CornerSigmas sigmas = cornerSigmas(view, detection, params_.corner_sigma);
    for (double& sigma : sigmas) sigma *= std::sqrt(params_.correlated_images);
    auto cost =
        cornersCost(&view.camera, view.T_base_camera.inverse(), marker.size, detection.corners, sigmas);
    problem_.AddResidualBlock(cost.release(), params_.robust_width > 0 ? &marker_loss_ : nullptr, base,
                              marker_pose, lensOf(view.camera_index, estimate));
  }

  double* lensOf(size_t camera, const MapEstimate& estimate) {
    const auto known = estimate.lenses.find(camera);
    const LensCorrection start = known == estimate.lenses.end() ? LensCorrection::Zero() : known->second;
    return lenses_.emplace(camera, start).first->second.data();
  }

  void addKnown(const MappedMarker& known) {
    const auto found = markers_.find(known.key);
    if (found == markers_.end()) return;
    if (known.covariance.isZero(0.0)) {
      problem_.SetParameterBlockConstant(found->second.data());
      held_.insert(known.key);
      return;
    }
    PosePrior prior{known.T_map_marker, known.covariance};
    prior.covariance.diagonal().array() += kExtraSigma * kExtraSigma;
    problem_.AddResidualBlock(priorCost(prior).release(), params_.robust_width > 0 ? &marker_loss_ : nullptr,
                              found->second.data());
  }

  void addOdometry() {
    for (auto a = bases_.begin(), b = a; a != bases_.end() && ++b != bases_.end(); a = b) {
      const auto step = odometryBetween(recording_, a->first, b->first, params_.odometry);
      if (step)
        problem_.AddResidualBlock(stepCost(*step).release(), &odometry_loss_, a->second.data(),
                                  b->second.data());
    }
  }

  void addFloor() {
    for (auto& entry : bases_)
      problem_.AddResidualBlock(floorCost(*params_.floor).release(), nullptr, entry.second.data());
  }

  void addLensPriors() {
    for (auto& entry : lenses_)
      if (params_.lens_sigma > 0)
        problem_.AddResidualBlock(lensCost(params_.lens_sigma).release(), nullptr, entry.second.data());
      else
        problem_.SetParameterBlockConstant(entry.second.data());
  }

  // From the covariance of the parameters: zero rows and columns for held markers and those that are not in
  // the problem. Ceres's quaternion manifold uses half the rotation angles.
  Eigen::MatrixXd ofMarkers(const Eigen::MatrixXd& parameters, const MarkerMap& map) const {
    const auto size = static_cast<Eigen::Index>(6 * map.markers().size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
    std::vector<Eigen::Index> rows;
    Eigen::Index row = 0;
    for (const auto& entry : map.markers()) {
      if (markers_.count(entry.first) != 0 && held_.count(entry.first) == 0) rows.push_back(row);
      row += 6;
    }
    Vector6d units;
    units << 1, 1, 1, 2, 2, 2;
    for (size_t i = 0; i < rows.size(); ++i)
      for (size_t j = 0; j < rows.size(); ++j)
        all.block<6, 6>(rows[i], rows[j]) =
            units.asDiagonal() *
            parameters.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * j)) *
            units.asDiagonal();
    return all;
  }

  const MarkerRecording& recording_;
  const AdjustmentParams& params_;
  PoseManifold manifold_;
  ceres::HuberLoss marker_loss_{params_.robust_width};
  ceres::HuberLoss odometry_loss_{kRobustOdometry};
  std::map<MarkerKey, PoseBlock> markers_;
  std::set<MarkerKey> held_;
  std::map<size_t, PoseBlock> bases_;
  LensCorrections lenses_;
  ceres::Problem problem_;
};

}  // namespace

std::optional<MapEstimate> adjustMap(const MarkerRecording& recording,
                                     const std::vector<RecordedObservation>& used, const MarkerMap& known,
                                     const MapEstimate& start, const AdjustmentParams& params) {
  if (used.empty()) return std::nullopt;
  AdjustmentProblem problem(recording, used, known, start, params);
  if (!problem.solve()) return std::nullopt;
  MapEstimate result = start;
  problem.write(result);
  return result;
}

std::optional<Eigen::MatrixXd> mapCovariance(const MarkerRecording& recording,
                                             const std::vector<RecordedObservation>& used,
                                             const MarkerMap& known, const MapEstimate& estimate,
                                             const AdjustmentParams& params) {
  if (used.empty()) return std::nullopt;
  return AdjustmentProblem(recording, used, known, estimate, params).covariance(estimate.map);
}

}  // namespace sextant
