# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Visual place recognition: localizes a robot in a map of photos."""
