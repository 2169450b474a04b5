// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/landmarks/source_monitor.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace sextant {
namespace {

constexpr double kWindow = 8;    // seconds in which a source is judged
constexpr double kSupport = 30;  // seconds in which another one must agree with the pose
constexpr double kLasting = 2;   // seconds for which the most probable pose takes a source to be wrong
constexpr size_t kLeast = 4;     // scans or images that contradict the pose
constexpr size_t kBlank = 10;    // scans in which nothing is observed of what should be in view

struct Texts {
  const char *name, *contradicts, *misses;
  size_t blank;  // scans or images that show nothing, after which this is reported
};

constexpr const char* kNothing =
    "nothing is observed where landmarks should be in view: is the camera covered, or its detector stopped?";

constexpr Texts kSources[] = {
    {"markers",
     "markers are not where the pose has them, but other sources agree with it: check the marker map, its "
     "frame and the pose of the camera on the robot",
     kNothing, kBlank},
    {"landmarks",
     "landmarks are not where the pose has them, but other sources agree with it: were they moved? Map them "
     "again",
     kNothing, kBlank},
    {"places",
     "the recognized places contradict the pose, but other sources agree with it: is it the place map of "
     "this building, in the frame of the other maps?",
     "the images have too little content to recognize a place: is the camera covered, or is it dark?",
     kLeast},
};
static_assert(std::size(kSources) == kPoseSources);

}  // namespace

void SourceMonitor::add(const LandmarkTimeline::Applied& applied) {
  std::map<PoseSource, double> wrong;
  for (const PoseSource each : applied.wrong) {
    const auto known = wrong_since_.find(each);
    wrong[each] = known == wrong_since_.end() ? applied.stamp : known->second;
  }
  wrong_since_ = std::move(wrong);
  if (!applied.places) {
    addScan(applied);
  } else if (*applied.places == PlaceUse::agrees) {
    note(PoseSource::places, applied.stamp, Verdict::supports);
  } else if (*applied.places == PlaceUse::contradicts) {
    note(PoseSource::places, applied.stamp, Verdict::contradicts);
  }
}

void SourceMonitor::addScan(const LandmarkTimeline::Applied& applied) {
  const LandmarkReport& report = applied.report;
  const PoseSource source = sourceOf(applied.detects);
  const bool is_elsewhere = report.rejected + report.unexpected + report.excluded > 0;
  if (report.lost) return;
  if (report.associated > 0) {
    note(source, applied.stamp, Verdict::supports);
  } else if (is_elsewhere) {
    note(source, applied.stamp, Verdict::contradicts);
  } else if (report.missed > 0) {
    note(source, applied.stamp, Verdict::misses);
  }
}

/// Scans and images arrive out of order by a little: the newest one decides what is old.
void SourceMonitor::note(PoseSource source, double stamp, Verdict verdict) {
  sources_[static_cast<size_t>(source)].push_back({stamp, verdict});
  newest_ = std::max(newest_, stamp);
  for (Source& each : sources_)
    each.erase(std::remove_if(each.begin(), each.end(),
                              [&](const Event& event) { return event.stamp < newest_ - kSupport; }),
               each.end());
}

size_t SourceMonitor::count(const Source& source, Verdict verdict) const {
  return static_cast<size_t>(std::count_if(source.begin(), source.end(), [&](const Event& event) {
    return event.verdict == verdict && event.stamp >= newest_ - kWindow;
  }));
}

/// Most of the time, or since it supported the pose for the last time, or to the pose that has become the
/// most probable one since then.
bool SourceMonitor::isContradicting(size_t index) const {
  const auto wrong = wrong_since_.find(static_cast<PoseSource>(index));
  if (wrong != wrong_since_.end() && newest_ >= wrong->second + kLasting) return true;
  const Source& source = sources_[index];
  const size_t against = count(source, Verdict::contradicts);
  if (against < kLeast) return false;
  const auto supports = [](const Event& event) { return event.verdict == Verdict::supports; };
  const auto last = std::find_if(source.rbegin(), source.rend(), supports);
  const auto since = std::count_if(source.rbegin(), last, [&](const Event& event) {
    return event.verdict == Verdict::contradicts && event.stamp >= newest_ - kWindow;
  });
  return against > count(source, Verdict::supports) || static_cast<size_t>(since) >= kLeast;
}

std::string SourceMonitor::supporting() const {
  std::string names;
  for (size_t i = 0; i < sources_.size(); ++i)
    if (const size_t number = count(sources_[i], Verdict::supports))
      names +=
          (names.empty() ? "" : ", ") + std::string(kSources[i].name) + " (" + std::to_string(number) + ")";
  return names.empty() ? "none" : names;
}

std::vector<std::string> SourceMonitor::problems() const {
  std::vector<std::string> found;
  for (size_t i = 0; i < sources_.size(); ++i) {
    const bool is_supported = std::any_of(sources_.begin(), sources_.end(), [&](const Source& other) {
      return &other != &sources_[i] && std::any_of(other.begin(), other.end(), [](const Event& event) {
        return event.verdict == Verdict::supports;
      });
    });
    if (is_supported && isContradicting(i)) found.emplace_back(kSources[i].contradicts);
    const size_t shown = count(sources_[i], Verdict::supports) + count(sources_[i], Verdict::contradicts);
    if (shown == 0 && count(sources_[i], Verdict::misses) >= kSources[i].blank)
      found.emplace_back(kSources[i].misses);
  }
  return found;
}

}  // namespace sextant
