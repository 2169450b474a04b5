# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Object detection in images, localization by depth, and tracking of a ball."""
