// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "sextant/geometry/pose.hpp"

namespace sextant {

inline Pose randomPose(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-3.1, 3.1);
  const auto draw = [&] { return uniform(random); };
  return poseFromXyzRpy({draw(), draw(), draw()}, {draw(), draw() / 2, draw()});
}

inline Matrix6d someCovariance() {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root.data()[i] = 0.01 * (i % 7) + (i % 7 == 0 ? 0.1 : 0.0);
  return root * root.transpose();
}

}  // namespace sextant
