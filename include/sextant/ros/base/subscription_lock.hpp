// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

namespace sextant {

/// Hold one while a nodelet subscribes or unsubscribes. roscpp loses a subscription that one thread makes
/// while another ends the only one of the same topic in this process: it never receives a message. Without a
/// master, subscribing waits for it, and so does the next lock.
class SubscriptionLock {
 public:
  /// Waits for the other locks of this process.
  SubscriptionLock();

 private:
  const std::lock_guard<std::mutex> lock_;
};

}  // namespace sextant
