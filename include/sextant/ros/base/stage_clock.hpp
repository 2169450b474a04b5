// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <chrono>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace sextant {

/// Mean and longest time of the stages of a callback since the last report, for diagnostics.
class StageClock {
 public:
  void start();
  /// Ends a stage that began at start() or at the end of the stage before.
  void finish(const char* stage);
  /// A row a stage, "mean / max ms", and the number of runs; begins anew.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Stage {
    std::string name;
    int runs = 0;
    double sum = 0.0, longest = 0.0;  // milliseconds
  };
  std::mutex mutex_;
  std::chrono::steady_clock::time_point begin_;
  std::vector<Stage> stages_;
};

}  // namespace sextant
