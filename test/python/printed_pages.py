# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A PDF as another program shows it: poppler's pictures, texts and facts."""

import subprocess

import cv2

import sextant


def poppler(tool, *arguments):
    done = subprocess.run([tool, *map(str, arguments)], stdout=subprocess.PIPE, check=True, timeout=60)
    return done.stdout.decode()


def pictures(pdf, dpi):
    """Grey pictures of the pages; a pixel's edge is 25.4 / dpi millimetres."""
    poppler("pdftoppm", "-gray", "-r", dpi, pdf, pdf.with_suffix(""))
    files = sorted(pdf.parent.glob(f"{pdf.stem}-*.pgm"))
    return [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in files]


def texts(pdf):
    """Words of every page, in the order of the page."""
    return [page.split() for page in poppler("pdftotext", "-layout", pdf, "-").split("\f")[:-1]]


def paper(pdf):
    """Width and height in millimetres."""
    line = next(line for line in poppler("pdfinfo", pdf).splitlines() if line.startswith("Page size"))
    return [25.4 / 72.0 * float(line.split()[index]) for index in (2, 4)]


def detector(family):
    params = sextant.DetectorParams()
    params.families, params.max_hamming = [family], 0
    return sextant.MarkerDetector(params)
