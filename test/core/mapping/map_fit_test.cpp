// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "test_recording.hpp"

namespace sextant {
namespace {

MapFit fitOfTheTruth(const SimulatedRecording& simulated) {
  MapFit fit(simulated.recording, 0.3, 30);
  fit.estimate = {simulated.truth, {simulated.T_map_base.begin(), simulated.T_map_base.end()}};
  return fit;
}

size_t detectionsOf(const SimulatedRecording& simulated) {
  size_t count = 0;
  for (const RecordedInstant& instant : simulated.recording) count += instant.views[0].detections.size();
  return count;
}

// In the first image with three markers, the first of them has an error of 20 px to the right.
size_t spoilOne(SimulatedRecording& simulated) {
  size_t instant = 0;
  while (simulated.recording[instant].views[0].detections.size() < 3) ++instant;
  for (auto& corner : simulated.recording[instant].views[0].detections[0].corners) corner.x() += 20;
  return instant;
}

TEST(MapFit, TheTruthExplainsAllButWhatIsSpoilt) {
  auto simulated = drive(roomWithMarkers(12), 40, 0, 1);
  EXPECT_EQ(fitOfTheTruth(simulated).placed().size(), detectionsOf(simulated));
  EXPECT_EQ(fitOfTheTruth(simulated).unexplained(), 0u);
  const size_t spoilt = spoilOne(simulated);
  const MapFit fit = fitOfTheTruth(simulated);
  EXPECT_EQ(fit.placed().size(), detectionsOf(simulated));
  EXPECT_EQ(fit.withinGate().size(), detectionsOf(simulated) - 1);
  const ObservationResidual residual = fit.residual({spoilt, 0, 0});
  EXPECT_FALSE(residual.used);
  EXPECT_NEAR(residual.rms, 20 * std::sqrt(0.5), 1e-6);  // in one of two coordinates
  EXPECT_NEAR(residual.squared_distance, 4 * std::pow(20 / 0.3, 2), 1e-3);
  const auto explained = fit.explained();
  for (size_t i = 0; i < explained.size(); ++i) {
    const bool several = simulated.recording[i].views[0].detections.size() > 1;
    EXPECT_EQ(explained[i].empty(), !several || i == spoilt) << i;
  }
}

TEST(MapFit, WhatHasNoPoseOrIsLeftOutIsNotPlaced) {
  const auto simulated = drive(roomWithMarkers(12), 40, 0, 1);
  MapFit fit = fitOfTheTruth(simulated);
  const size_t of_the_first = fit.observations().at(key(0)).size();
  ASSERT_GT(of_the_first, 0u);
  fit.begin({key(0)});
  EXPECT_EQ(fit.placed().size(), detectionsOf(simulated) - of_the_first);
  fit.begin({});
  const size_t of_the_instant = simulated.recording[7].views[0].detections.size();
  fit.estimate.T_map_base[7].reset();
  EXPECT_EQ(fit.placed().size(), detectionsOf(simulated) - of_the_instant);
  EXPECT_EQ(fit.unexplained(), of_the_instant);
  EXPECT_TRUE(fit.posesOf(fit.placed())[7].empty());
}

TEST(MapFit, MeasuresTheNoiseOfTheImages) {
  const auto scaleFor = [](double sigma) {
    MapFit fit = fitOfTheTruth(drive(roomWithMarkers(12), 150, sigma, 1));
    fit.measureNoise(fit.placed());
    const double scale = fit.noiseScales().at(0);
    EXPECT_EQ(fit.recording()[0].views[0].noise_scale > 1, sigma > 0.3);
    fit.begin({});
    EXPECT_EQ(fit.noiseScales().at(0), 1);
    return scale;
  };
  const double usual = scaleFor(0.15), twice = scaleFor(0.6);
  EXPECT_NEAR(twice / usual, 4, 0.2);
}

}  // namespace
}  // namespace sextant
