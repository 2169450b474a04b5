// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/mapping/keyframes.hpp"

#include <gtest/gtest.h>

#include "test_recording.hpp"

namespace sextant {
namespace {

std::vector<size_t> allOf(const MarkerRecording& recording) {
  std::vector<size_t> all(recording.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

// Half of its images, and then at rest where the last one was taken.
MarkerRecording stopped(int images, double sigma) {
  const MarkerMap truth = roomWithMarkers(12);
  auto simulated = drive(truth, images, sigma, 1);
  std::mt19937 random(2);
  const size_t last = images / 2;
  for (size_t i = last + 1; i < simulated.recording.size(); ++i) {
    MarkerView& view = simulated.recording[i].views[0];
    view = recordedView(truth, view.camera, simulated.T_map_base[last], sigma, random);
  }
  return simulated.recording;
}

TEST(Keyframes, AreAllOfAMovingCamera) {
  const auto recording = drive(roomWithMarkers(12), 60, 0.2, 1).recording;
  EXPECT_EQ(keyframes(recording), allOf(recording));
}

TEST(Keyframes, AreNoMoreOfACameraAtRest) {
  auto recording = stopped(60, 0.2);
  ASSERT_GT(recording[30].views[0].detections.size(), 1u);
  EXPECT_EQ(keyframes(recording).back(), 30u);
  for (size_t i = 31; i < 60; i += 2) recording[i].views[0].detections.pop_back();  // one is not always seen
  EXPECT_EQ(keyframes(recording).back(), 30u);
  recording[45].views[0].detections.back().key = key(99);  // a new one
  EXPECT_EQ(keyframes(recording).back(), 45u);
}

TEST(Keyframes, KeepWhatOdometryNeeds) {
  auto recording = stopped(60, 0.2);
  recording[40].T_odom_base = Pose::Identity();  // from 41 on it is unknown again
  recording[50].views.clear();
  const auto found = keyframes(recording);
  const std::vector<size_t> expected = {40, 41, 50};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), found.end() - 3));
  recording[55].drive = recording[56].drive = 1;
  EXPECT_EQ(keyframes(recording).back(), 57u);
}

}  // namespace
}  // namespace sextant
