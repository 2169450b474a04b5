# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Error of all conversions of messages."""


class DamagedMessage(ValueError):
    """A single unusable message, with the reason; other messages of its topic may be usable."""
