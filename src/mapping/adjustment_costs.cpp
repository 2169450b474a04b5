// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "adjustment_costs.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/cost_function_to_functor.h>
#include <ceres/rotation.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

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

// CameraModel::projectWithJacobian() for Ceres.
class Lens : public ceres::SizedCostFunction<2, 3> {
 public:
  explicit Lens(const CameraModel* camera) : camera_(camera) {}

  bool Evaluate(double const* const* point, double* pixel, double** jacobians) const override {
    const auto projection = camera_->projectWithJacobian(Eigen::Map<const Eigen::Vector3d>(point[0]));
    if (!projection) return false;
    Eigen::Map<Eigen::Vector2d>(pixel, 2) = projection->pixel;
    using Jacobian = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
    if (jacobians && jacobians[0]) Eigen::Map<Jacobian>{jacobians[0]} = projection->jacobian;
    return true;
  }

 private:
  const CameraModel* camera_;
};

struct CornersError {
  CornersError(const CameraModel* camera, const Pose& T_camera_base, double size, const Corners& corners,
               const CornerSigmas& sigmas)
      : lens(new Lens(camera)),
        T_camera_base(T_camera_base),
        points(markerCorners(size)),
        corners(corners),
        sigmas(sigmas) {}

  template <typename T>
  bool operator()(const T* T_map_base, const T* T_map_marker, T* residuals) const {
    const BlockView<T> base(T_map_base), marker(T_map_marker);
    for (int k = 0; k < 4; ++k) {
      const Vector3<T> p_map = marker.q * points[k].cast<T>() + marker.p;
      const Vector3<T> p_base = base.q.conjugate() * (p_map - base.p);
      const Vector3<T> p_camera = T_camera_base.linear().cast<T>() * p_base + T_camera_base.translation();
      T pixel[2];
      if (!lens(p_camera.data(), pixel)) return false;
      for (int i = 0; i < 2; ++i) residuals[2 * k + i] = (pixel[i] - corners[k][i]) / sigmas[k];
    }
    return true;
  }

  ceres::CostFunctionToFunctor<2, 3> lens;
  Pose T_camera_base;
  std::array<Eigen::Vector3d, 4> points;
  Corners corners;
  CornerSigmas sigmas;
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
  using Cost = ceres::AutoDiffCostFunction<CornersError, 8, 7, 7>;
  return std::make_unique<Cost>(new CornersError(camera, T_camera_base, size, corners, sigmas));
}

std::unique_ptr<ceres::CostFunction> stepCost(const PosePrior& T_a_b) {
  return std::make_unique<ceres::AutoDiffCostFunction<StepError, 6, 7, 7>>(new StepError(T_a_b));
}

std::unique_ptr<ceres::CostFunction> priorCost(const PosePrior& known) {
  return std::make_unique<ceres::AutoDiffCostFunction<PriorError, 6, 7>>(new PriorError(known));
}

std::unique_ptr<ceres::CostFunction> floorCost(const FloorPrior& floor) {
  return std::make_unique<ceres::AutoDiffCostFunction<FloorError, 3, 7>>(new FloorError{floor});
}

}  // namespace sextant
