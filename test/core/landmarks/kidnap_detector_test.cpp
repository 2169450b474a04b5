// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/kidnap_detector.hpp"

#include <gtest/gtest.h>

namespace sextant {
namespace {

constexpr int kEstablished = 10;  // landmarks, keys 0 to 9

KidnapDetector makeDetector(int lost_after = 10) {
  KidnapDetector detector(lost_after);
  detector.confirm(kEstablished);
  return detector;
}

KidnapDetector::Evidence evidenceOf(const std::vector<int>& observed, const std::vector<int>& missed,
                                    int unknown = 0) {
  return {observed, missed, 0, unknown, kEstablished + 5};
}

void update(KidnapDetector& detector, int times, const KidnapDetector::Evidence& evidence) {
  for (int i = 0; i < times; ++i) detector.update(evidence);
}

TEST(KidnapDetector, TwoMissingLandmarksMakeTheRobotLost) {
  KidnapDetector detector = makeDetector();
  update(detector, 9, evidenceOf({}, {1, 2}, 1));
  EXPECT_FALSE(detector.isLost());
  EXPECT_FALSE(detector.isConsistent());
  update(detector, 1, evidenceOf({}, {1, 2}, 1));
  EXPECT_TRUE(detector.isLost());
}

TEST(KidnapDetector, ASensorThatObservesNothingDoesNot) {
  KidnapDetector detector = makeDetector();
  update(detector, 1000, evidenceOf({}, {1, 2}));
  EXPECT_FALSE(detector.isLost());
  update(detector, 1, evidenceOf({}, {1, 2}, 1));  // it works, but observes something else
  EXPECT_TRUE(detector.isLost());
}

TEST(KidnapDetector, OneMissingLandmarkDoesNot) {
  KidnapDetector detector = makeDetector();
  update(detector, 1000, evidenceOf({}, {7}));
  EXPECT_FALSE(detector.isLost());
}

TEST(KidnapDetector, ContradictionsMakeTheRobotLost) {
  KidnapDetector detector = makeDetector();
  update(detector, 10, {{}, {}, 1, 0, kEstablished});
  EXPECT_TRUE(detector.isLost());
}

TEST(KidnapDetector, ConfirmedLandmarksCancelMisses) {
  KidnapDetector detector = makeDetector();
  for (int i = 0; i < 100; ++i) {
    update(detector, 3, evidenceOf({}, {1, 2}));
    update(detector, 1, evidenceOf({1, 3}, {2}));
  }
  EXPECT_TRUE(detector.isConsistent());
}

TEST(KidnapDetector, OneLandmarkAmongUnknownOnesCancelsNothing) {
  KidnapDetector detector = makeDetector();
  for (int i = 0; i < 10; ++i) {
    update(detector, 1, evidenceOf({}, {1, 2}));
    update(detector, 1, evidenceOf({1}, {}, 1));
  }
  EXPECT_TRUE(detector.isLost());
}

TEST(KidnapDetector, UnknownLandmarksContradictACompleteMap) {
  KidnapDetector::Evidence evidence = evidenceOf({1}, {}, 4);  // at a wrong pose, one is associated by chance
  KidnapDetector mapping = makeDetector();
  update(mapping, 1000, evidence);
  EXPECT_TRUE(mapping.isConsistent());
  evidence.is_complete = true;
  KidnapDetector complete = makeDetector();
  update(complete, 9, evidence);
  EXPECT_FALSE(complete.isLost());
  update(complete, 1, evidence);
  EXPECT_TRUE(complete.isLost());
}

TEST(KidnapDetector, AFewUnknownLandmarksDoNotContradictACompleteMap) {
  KidnapDetector::Evidence evidence = evidenceOf({1, 2}, {}, 3);
  evidence.is_complete = true;
  KidnapDetector detector = makeDetector();
  update(detector, 1000, evidence);
  EXPECT_TRUE(detector.isConsistent());
}

TEST(KidnapDetector, MissedLandmarksContradictACompleteMapAlsoIfOneIsObserved) {
  KidnapDetector::Evidence evidence = evidenceOf({1}, {2, 3});
  evidence.is_complete = true;
  KidnapDetector detector = makeDetector();
  update(detector, 10, evidence);
  EXPECT_TRUE(detector.isLost());
}

TEST(KidnapDetector, SlipsInARowMakeTheRobotLost) {
  KidnapDetector::Evidence slip = evidenceOf({1, 2}, {});
  slip.slipped = true;
  KidnapDetector once = makeDetector();
  update(once, 1, slip);
  update(once, 1, evidenceOf({1, 2}, {}));
  EXPECT_TRUE(once.isConsistent());
  KidnapDetector often = makeDetector();
  update(often, 4, slip);
  EXPECT_TRUE(often.isLost());
}

TEST(KidnapDetector, AnEmptyScanChangesNothing) {
  KidnapDetector detector = makeDetector();
  update(detector, 9, evidenceOf({}, {1, 2}));
  update(detector, 100, evidenceOf({}, {}));
  EXPECT_FALSE(detector.isLost());
  EXPECT_FALSE(detector.isConsistent());
}

TEST(KidnapDetector, IsNeverLostWhenDisabled) {
  KidnapDetector detector = makeDetector(0);
  update(detector, 1000, {{}, {1, 2, 3}, 5, 0, kEstablished});
  EXPECT_FALSE(detector.isLost());
}

TEST(KidnapDetector, NewLandmarksAreProvisionalUntilObservedWithEstablishedOnes) {
  KidnapDetector detector = makeDetector();
  update(detector, 100, evidenceOf({11, 12}, {}));
  EXPECT_EQ(detector.firstProvisional(), kEstablished);
  update(detector, 2, evidenceOf({3, 11}, {}));
  update(detector, 1, evidenceOf({11}, {}));  // not successive
  update(detector, 2, evidenceOf({3, 11}, {}));
  update(detector, 1, evidenceOf({3, 11}, {4}));  // as many are missed
  update(detector, 2, evidenceOf({3, 11}, {}));
  EXPECT_EQ(detector.firstProvisional(), kEstablished);
  update(detector, 1, evidenceOf({3, 11}, {}));
  EXPECT_EQ(detector.firstProvisional(), kEstablished + 5);
}

TEST(KidnapDetector, OnlyEstablishedLandmarksCount) {
  KidnapDetector detector = makeDetector();
  update(detector, 10, evidenceOf({11, 12, 13}, {1, 2}));  // provisional landmarks cancel nothing
  EXPECT_TRUE(detector.isLost());
  KidnapDetector other = makeDetector();
  update(other, 10, evidenceOf({}, {11, 12}));
  EXPECT_TRUE(other.isConsistent());
}

TEST(KidnapDetector, TheFirstLandmarksAreTheMap) {
  KidnapDetector detector(10);
  detector.update({{}, {}, 0, 2, 0});
  detector.update({{}, {}, 0, 0, 3});
  EXPECT_EQ(detector.firstProvisional(), 3);
}

}  // namespace
}  // namespace sextant
