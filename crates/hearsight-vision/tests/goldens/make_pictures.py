"""Writes what OpenCV and numpy make of synthetic pictures, for tests/vision/pictures.rs and the tests inside src.

    pip install opencv-python-headless==4.10.0.84 "numpy<2"
    python make_pictures.py

The pictures come from a formula that tests/vision/common.rs repeats, so only results are kept: checksums where every pixel
must agree, numbers where they may round.
"""

import json
import pathlib

import cv2
import numpy as np

GRAY = (157, 83)
COLOUR = (211, 97)
SIZES = [(156, 82), (143, 75), (100, 83), (71, 38), (60, 20), (23, 12), (157, 40), (200, 90)]
MEDIANS = [1, 3, 5, 7, 9, 15]
DILATIONS = [(1, 1), (3, 3), (15, 5), (4, 6), (31, 9), (1, 8)]
ELLIPSES = [
    (20.0, 10.0, 40.0, 60.0),
    (21.3, 10.7, 40.9, 61.1),
    (60.25, 30.5, 11.0, 13.5),
    (-12.0, 40.0, 50.0, 40.0),
    (190.5, -8.0, 30.0, 44.0),
    (100.0, 60.0, 90.0, 70.0),
    (150.0, 20.0, 5.0, 7.0),
]


class Noise:
    """The linear congruential generator of Numerical Recipes, its highest byte."""

    def __init__(self, seed):
        self.state = seed

    def next(self):
        self.state = (self.state * 1_664_525 + 1_013_904_223) & 0xFFFF_FFFF
        return self.state >> 24


def picture(width, height, channels, seed):
    """A slope with discs and noise."""
    noise = Noise(seed)
    discs = []
    for _ in range(8):
        x, y, r = noise.next() * width // 256, noise.next() * height // 256, 4 + noise.next() % 20
        discs.append((x, y, r, [noise.next() for _ in range(channels)]))
    out = np.zeros((height, width, channels), np.uint8)
    for y in range(height):
        for x in range(width):
            value = [(x * 2 + y * (channel + 1)) % 200 for channel in range(channels)]
            for disc_x, disc_y, r, colour in discs:
                if (x - disc_x) ** 2 + (y - disc_y) ** 2 <= r * r:
                    value = colour
            for channel in range(channels):
                out[y, x, channel] = min(255, value[channel] + noise.next() % 24)
    return out[:, :, 0].copy() if channels == 1 else out


def checksum(data):
    """FNV-1a, 64 bits."""
    value = 0xCBF2_9CE4_8422_2325
    for byte in data:
        value = ((value ^ byte) * 0x100_0000_01B3) & 0xFFFF_FFFF_FFFF_FFFF
    return f"{value:016x}"


def histogram(rgb, ellipse, bins=10):
    """Bregonzio et al., eq. 11 with K(r^2) = 1 - r^2; rectangles count from pixels' edges."""
    left, top, width, height = ellipse
    ys, xs = np.mgrid[0 : rgb.shape[0], 0 : rgb.shape[1]].astype(float)
    u = (xs + 0.5 - left - width / 2) / (width / 2)
    v = (ys + 0.5 - top - height / 2) / (height / 2)
    kernel = np.maximum(1 - u * u - v * v, 0)
    index = rgb.astype(int) * bins // 256
    index = (index[:, :, 0] * bins + index[:, :, 1]) * bins + index[:, :, 2]
    sums = np.bincount(index.ravel(), kernel.ravel(), bins**3)
    return sums / sums.sum()


def main():
    gray = picture(*GRAY, 1, 1)
    sums, squares, tilted = cv2.integral3(gray)
    first, second = picture(*COLOUR, 3, 2), picture(*COLOUR, 3, 3)
    second[: COLOUR[1] // 2] = np.clip(
        first[: COLOUR[1] // 2].astype(int) + (second[: COLOUR[1] // 2] % 40).astype(int) - 10, 0, 255
    )
    changed = (cv2.absdiff(first, second) > 20).any(axis=2).astype(np.uint8) * 255
    ellipse = lambda size: cv2.getStructuringElement(cv2.MORPH_ELLIPSE, size)
    cleaned = cv2.dilate(cv2.medianBlur(changed, 5), ellipse((15, 5)))
    sparse = ((picture(*GRAY, 1, 4) % 24) < 8).astype(np.uint8) * 255
    _, _, stats, centroids = cv2.connectedComponentsWithStats(sparse, connectivity=8)
    regions = [[*map(int, s), *map(float, c)] for s, c in zip(stats[1:], centroids[1:])]
    reference = histogram(first, ELLIPSES[0])
    goldens = {
        "gray": checksum(gray.tobytes()),
        "first": checksum(first.tobytes()),
        "second": checksum(second.tobytes()),
        "sums": checksum(sums.astype("<u4").tobytes()),
        "squares": checksum(squares.astype("<u8").tobytes()),
        "tilted": checksum(tilted.astype("<u4").tobytes()),
        "resized": [
            [*size, checksum(cv2.resize(gray, size, interpolation=cv2.INTER_LINEAR_EXACT).tobytes())]
            for size in SIZES
        ],
        "changed": checksum(changed.tobytes()),
        "cleaned": checksum(cleaned.tobytes()),
        "medians": [
            [size, checksum((cv2.medianBlur(sparse, size) if size > 1 else sparse).tobytes())] for size in MEDIANS
        ],
        "dilations": [[*size, checksum(cv2.dilate(sparse, ellipse(size)).tobytes())] for size in DILATIONS],
        "regions": regions,
        "ellipses": [
            [*box, float(np.sqrt(reference * histogram(first, box)).sum())] for box in ELLIPSES
        ],
    }
    path = pathlib.Path(__file__).with_name("pictures.json")
    path.write_text(json.dumps(goldens, indent=1) + "\n")


main()
