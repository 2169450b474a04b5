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

/// Mean and maximum duration of the stages of a callback, for diagnostics.
class StageClock {
 public:
  void start();  ///< starts the first stage
  /// Ends a stage, which began at start() or at the end of the previous stage.
  void finish(const char* stage);
  /// Adds mean and maximum in ms and the number of runs of each stage since the last call, and restarts.
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
