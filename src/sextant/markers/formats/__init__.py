# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Marker map formats of Sextant and of other packages, one module per format."""
