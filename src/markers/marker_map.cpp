// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map.hpp"

#include <stdexcept>

#include "sextant/markers/marker_family.hpp"

namespace sextant {
namespace {

constexpr double kMaxSize = 100.0;  // metres

[[noreturn]] void refuse(const MappedMarker& marker, const std::string& why) {
  throw std::invalid_argument("marker " + std::to_string(marker.key.id) + " (" + marker.key.family +
                              "): " + why);
}

MappedMarker checked(MappedMarker marker) {
  const int count = familySize(marker.key.family);
  marker.key.family = canonicalFamily(marker.key.family);
  if (marker.key.id < 0 || marker.key.id >= count)
    refuse(marker, "the ids of this family are 0 to " + std::to_string(count - 1));
  if (!(marker.size > 0 && marker.size <= kMaxSize)) refuse(marker, "size must be in (0, 100] m");
  if (!isFinite(marker.T_map_marker)) refuse(marker, "the pose is not finite");
  if (!isCovariance(marker.covariance))
    refuse(marker, "the covariance is not symmetric and positive semidefinite");
  if (marker.name.empty()) marker.name = marker.key.family + "/" + std::to_string(marker.key.id);
  return marker;
}

}  // namespace

const MappedMarker* MarkerMap::find(const MarkerKey& key) const {
  const auto entry = markers_.find(key);
  return entry == markers_.end() ? nullptr : &entry->second;
}

void MarkerMap::requireFreeName(const std::string& name) const {
  const auto named = [&](const auto& other) { return other.name == name; };
  const bool marker =
      std::any_of(markers_.begin(), markers_.end(), [&](const auto& entry) { return named(entry.second); });
  if (name == frame_) throw std::invalid_argument("'" + name + "' is the frame of the map");
  if (name.empty() || name.find_first_of(" \t\n") != std::string::npos || name[0] == '/')
    throw std::invalid_argument("'" + name + "' cannot name a tf frame");
  if (marker || std::any_of(frames_.begin(), frames_.end(), named))
    throw std::invalid_argument("the name '" + name + "' is used twice");
}

void MarkerMap::add(MappedMarker marker) {
  marker = checked(std::move(marker));
  if (find(marker.key)) refuse(marker, "it is listed twice");
  requireFreeName(marker.name);
  markers_.emplace(marker.key, std::move(marker));
}

void MarkerMap::set(MappedMarker marker) {
  marker = checked(std::move(marker));
  const auto old = markers_.find(marker.key);
  if (old == markers_.end() || old->second.name != marker.name) requireFreeName(marker.name);
  markers_.insert_or_assign(marker.key, std::move(marker));
}

void MarkerMap::addFrame(MappedFrame frame) {
  requireFreeName(frame.name);
  if (frame.parent.empty() || frame.parent == frame.name)
    throw std::invalid_argument("frame '" + frame.name + "' cannot have the parent '" + frame.parent + "'");
  if (!isFinite(frame.T_parent_frame))
    throw std::invalid_argument("frame '" + frame.name + "': the pose is not finite");
  frames_.push_back(std::move(frame));
}

}  // namespace sextant
