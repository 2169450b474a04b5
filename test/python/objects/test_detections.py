# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images that a detector refuses."""

import numpy as np
import pytest

from sextant.objects.detections import check_image


@pytest.mark.parametrize(
    "shape, kind", [((4, 4), "uint8"), ((4, 4, 4), "uint8"), ((0, 4, 3), "uint8"), ((4, 4, 3), "float32")]
)
def test_an_image_without_colours_is_refused(shape, kind):
    with pytest.raises(ValueError, match=r"it must be uint8 \(height, width, 3\)"):
        check_image(np.zeros(shape, kind))
