// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "adjustment_costs.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <utility>

#include "sextant/mapping/lens_correction.hpp"

namespace sextant {
namespace {

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <typename T>
struct BlockView {
  explicit BlockView(const T* block) : p(block), q(block + 3) {}
  Eigen::Map<const Vector3<T>> p;
  Eigen::Map<const Eigen::Quaternion<T>> q;
};

// A vector v turned by a quaternion (u, w), q v = v + 2 w (u x v) + 2 u x (u x v), and its derivatives. They
// hold for any norm of the quaternion, as Ceres moves it in all four coordinates.
struct Turned {
  Turned(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) : by_vector(q.toRotationMatrix()) {
    const Eigen::Vector3d u = q.vec();
    vector = by_vector * v;
    by_quaternion.leftCols<3>() = -2 * q.w() * skew(v) + 2 * (u * v.transpose() - 2 * v * u.transpose());
    by_quaternion.leftCols<3>().diagonal().array() += 2 * u.dot(v);
    by_quaternion.col(3) = 2 * u.cross(v);
  }

  Eigen::Vector3d vector;
  Eigen::Matrix3d by_vector;
  Eigen::Matrix<double, 3, 4> by_quaternion;  // x y z w
};

class CornersCost : public ceres::SizedCostFunction<8, 7, 7, kLensModes> {
 public:
  CornersCost(const CameraModel* camera, const Pose& T_camera_base, double size, const Corners& corners,
              const CornerSigmas& sigmas)
      : camera_(camera),
        T_camera_base_(T_camera_base),
        points_(markerCorners(size)),
        corners_(corners),
        sigmas_(sigmas) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    for (int k = 0; k < 4; ++k)
      if (!evaluateCorner(k, blocks, residuals + 2 * k, jacobians)) return false;
    return true;
  }

 private:
  template <int Columns>
  using Rows = Eigen::Map<Eigen::Matrix<double, 2, Columns, Eigen::RowMajor>>;

  bool evaluateCorner(int k, double const* const* blocks, double* residual, double** jacobians) const {
    const BlockView<double> base(blocks[0]), marker(blocks[1]);
    const Turned in_map(marker.q, points_[k]);
    const Turned in_base(base.q.conjugate(), in_map.vector + marker.p - base.p);
    const auto seen = camera_->projectWithJacobian(T_camera_base_ * in_base.vector);
    if (!seen) return false;
    const Eigen::Matrix<double, 2, kLensModes> modes = lensModes(*camera_, seen->pixel) / sigmas_[k];
    const LensCorrection lens = Eigen::Map<const LensCorrection>(blocks[2]);
    Eigen::Map<Eigen::Vector2d>(residual, 2) = (seen->pixel - corners_[k]) / sigmas_[k] + modes * lens;
    if (!jacobians) return true;
    const Eigen::Matrix2d by_pixel = Eigen::Matrix2d::Identity() + lensJacobian(*camera_, seen->pixel, lens);
    const Eigen::Matrix<double, 2, 3> by_base_point =
        by_pixel * seen->jacobian * T_camera_base_.linear() / sigmas_[k];
    const Eigen::Matrix<double, 2, 3> by_map_point = by_base_point * in_base.by_vector;
    if (jacobians[0]) {
      Eigen::Matrix<double, 2, 4> by_conjugate = by_base_point * in_base.by_quaternion;
      by_conjugate.leftCols<3>() *= -1;
      Rows<7>(jacobians[0] + 14 * k) << -by_map_point, by_conjugate;
    }
    if (jacobians[1]) Rows<7>(jacobians[1] + 14 * k) << by_map_point, by_map_point * in_map.by_quaternion;
    if (jacobians[2]) Rows<kLensModes>(jacobians[2] + 2 * kLensModes * k) = modes;
    return true;
  }

  const CameraModel* camera_;
  Pose T_camera_base_;
  std::array<Eigen::Vector3d, 4> points_;
  Corners corners_;
  CornerSigmas sigmas_;
};

// Error of a pose (p, q) against a prior, see poseError().
template <typename T>
void whitenedError(const PosePrior& known, const Matrix6d& whitening, const Vector3<T>& p,
                   const Eigen::Quaternion<T>& q, T* residuals) {
  const Eigen::Quaternion<T> turn = Eigen::Quaterniond(known.T_map_base.linear()).cast<T>() * q.conjugate();
  const T wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  Eigen::Matrix<T, 6, 1> error;
  error.template head<3>() = known.T_map_base.translation() - p;
  ceres::QuaternionToAngleAxis(wxyz, error.data() + 3);
  Eigen::Map<Eigen::Matrix<T, 6, 1>>(residuals, 6, 1) = whitening.cast<T>() * error;
}

// W with W' W = covariance^-1.
Matrix6d whitening(const Matrix6d& covariance) {
  const Matrix6d L = covariance.llt().matrixL();
  return L.triangularView<Eigen::Lower>().solve(Matrix6d::Identity());
}

struct StepError {
  explicit StepError(PosePrior T_a_b) : known(std::move(T_a_b)), W(whitening(known.covariance)) {}

  template <typename T>
  bool operator()(const T* T_map_a, const T* T_map_b, T* residuals) const {
    const BlockView<T> a(T_map_a), b(T_map_b);
    whitenedError<T>(known, W, a.q.conjugate() * (b.p - a.p), a.q.conjugate() * b.q, residuals);
    return true;
  }

  PosePrior known;
  Matrix6d W;
};

struct PriorError {
  explicit PriorError(PosePrior prior) : known(std::move(prior)), W(whitening(known.covariance)) {}

  template <typename T>
  bool operator()(const T* pose, T* residuals) const {
    const BlockView<T> block(pose);
    whitenedError<T>(known, W, block.p, block.q, residuals);
    return true;
  }

  PosePrior known;
  Matrix6d W;
};

struct LensError {
  template <typename T>
  bool operator()(const T* lens, T* residuals) const {
    for (int i = 0; i < kLensModes; ++i) residuals[i] = lens[i] / sigma;
    return true;
  }

  double sigma;  // pixels
};

struct FloorError {
  template <typename T>
  bool operator()(const T* T_map_base, T* residuals) const {
    const BlockView<T> base(T_map_base);
    const Vector3<T> up = base.q * Eigen::Vector3d::UnitZ().cast<T>();
    residuals[0] = base.p.z() / floor.height_sigma;
    residuals[1] = up.x() / floor.tilt_sigma;
    residuals[2] = up.y() / floor.tilt_sigma;
    return true;
  }

  FloorPrior floor;
};

}  // namespace

PoseBlock blockFromPose(const Pose& pose) {
  PoseBlock block;
  Eigen::Map<Eigen::Vector3d>(block.data()) = pose.translation();
  Eigen::Map<Eigen::Quaterniond>(block.data() + 3) = Eigen::Quaterniond(pose.linear()).normalized();
  return block;
}

Pose poseFromBlock(const PoseBlock& block) {
  const BlockView<double> view(block.data());
  Pose pose = Pose::Identity();
  pose.linear() = view.q.normalized().toRotationMatrix();
  pose.translation() = view.p;
  return pose;
}

std::unique_ptr<ceres::CostFunction> cornersCost(const CameraModel* camera, const Pose& T_camera_base,
                                                 double size, const Corners& corners,
                                                 const CornerSigmas& sigmas) {
  return std::make_unique<CornersCost>(camera, T_camera_base, size, corners, sigmas);
}

std::unique_ptr<ceres::CostFunction> stepCost(const PosePrior& T_a_b) {
  return std::make_unique<ceres::AutoDiffCostFunction<StepError, 6, 7, 7>>(new StepError(T_a_b));
}

std::unique_ptr<ceres::CostFunction> priorCost(const PosePrior& known) {
  return std::make_unique<ceres::AutoDiffCostFunction<PriorError, 6, 7>>(new PriorError(known));
}

std::unique_ptr<ceres::CostFunction> lensCost(double sigma) {
  return std::make_unique<ceres::AutoDiffCostFunction<LensError, kLensModes, kLensModes>>(
      new LensError{sigma});
}

std::unique_ptr<ceres::CostFunction> floorCost(const FloorPrior& floor) {
  return std::make_unique<ceres::AutoDiffCostFunction<FloorError, 3, 7>>(new FloorError{floor});
}

}  // namespace sextant
