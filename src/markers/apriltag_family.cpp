// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/apriltag_family.hpp"

extern "C" {  // the headers of libapriltag 0.10 do not declare it
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>
#if __has_include(<apriltag/tag36h10.h>)  // libapriltag 0.10 of Debian 11 lacks it
#include <apriltag/tag36h10.h>
#define SEXTANT_TAG36H10 1
#endif
}

#include <algorithm>
#include <map>

namespace sextant {
namespace {

struct Functions {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

const std::map<std::string, Functions>& table() {
  static const std::map<std::string, Functions> functions = {
      {"tag16h5", {tag16h5_create, tag16h5_destroy}},
      {"tag25h9", {tag25h9_create, tag25h9_destroy}},
#ifdef SEXTANT_TAG36H10
      {"tag36h10", {tag36h10_create, tag36h10_destroy}},
#endif
      {"tag36h11", {tag36h11_create, tag36h11_destroy}},
      {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
      {"tagCircle49h12", {tagCircle49h12_create, tagCircle49h12_destroy}},
      {"tagCustom48h12", {tagCustom48h12_create, tagCustom48h12_destroy}},
      {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}},
      {"tagStandard52h13", {tagStandard52h13_create, tagStandard52h13_destroy}}};
  return functions;
}

}  // namespace

std::vector<std::string> aprilTagFamilies() {
  std::vector<std::string> names;
  for (const auto& entry : table()) names.push_back(entry.first);
  return names;
}

AprilTagFamily makeAprilTagFamily(const std::string& name) {
  const Functions& functions = table().at(name);
  AprilTagFamily family(functions.create(), functions.destroy);
#ifndef SEXTANT_TAG36H10
  family->ncodes =
      std::min(family->ncodes, 65536u);  // libapriltag 0.10 stores ids in 16 bits: tagCircle49h12
#endif
  return family;
}

}  // namespace sextant
