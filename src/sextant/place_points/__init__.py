# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points of place maps whose photos have poses, and metric poses by them."""
