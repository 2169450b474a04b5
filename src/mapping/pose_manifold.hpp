// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Poses as parameters of Ceres: position and quaternion. Ceres 2.1 replaced local parameterizations by
// manifolds, which 2.2 has only.
#pragma once

#include <ceres/problem.h>
#include <ceres/version.h>
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
#define SEXTANT_CERES_MANIFOLDS 1
#include <ceres/manifold.h>
#include <ceres/product_manifold.h>
#else
#include <ceres/local_parameterization.h>
#endif

namespace sextant {

#ifdef SEXTANT_CERES_MANIFOLDS

using PoseManifold = ceres::ProductManifold<ceres::EuclideanManifold<3>, ceres::EigenQuaternionManifold>;

inline void keepManifolds(ceres::Problem::Options& options) {
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
}

#else

class PoseManifold : public ceres::ProductParameterization {
 public:
  PoseManifold()
      : ProductParameterization(new ceres::IdentityParameterization(3),
                                new ceres::EigenQuaternionParameterization) {}
};

inline void keepManifolds(ceres::Problem::Options& options) {
  options.local_parameterization_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
}

#endif

}  // namespace sextant
