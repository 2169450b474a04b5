# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Remembered places: where am I at all, from photos of an experience map."""
