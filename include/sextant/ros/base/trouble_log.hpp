// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <map>
#include <mutex>
#include <string>

namespace sextant {

/// Counts problems by kind, logs each kind at most once a minute and reports all in diagnostics.
class TroubleLog {
 public:
  /// @param name of the node or nodelet in log messages
  explicit TroubleLog(std::string name) : name_(std::move(name)) {}

  /// Reports a problem. @param kind short and fixed, e.g. "camera_info"; @param text the problem and its
  /// remedy
  void report(const std::string& kind, const std::string& text);
  /// Reports a rejected request: logged every time as an error, without effect on the summary.
  void refused(const std::string& kind, const std::string& text);
  /// Ends the current problem: the last message was processed successfully.
  void succeeded();
  /// Adds the summary (WARN while there is a problem) and the count of each kind.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  struct Kind {
    unsigned long count = 0;
    double last_logged = -1e9;  // seconds of the steady clock
  };
  std::string name_;
  mutable std::mutex mutex_;
  std::map<std::string, Kind> kinds_;
  std::string current_;  // empty: no problem
};

}  // namespace sextant
