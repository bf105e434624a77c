"""Writes where OpenCV's meanShift ends on the back-projection of a head's colours, for tests/vision/mean_shift.rs.

    pip install opencv-python-headless==4.10.0.84 "numpy<2"
    python make_mean_shift.py

The frames come from a formula that the test repeats: a head of two colours, mixed, before a wall with patches. The model is the
histogram of the head's ellipse in 10 x 10 x 10 bins with the Epanechnikov kernel, given to calcBackProject.
"""

import json
import pathlib

import cv2
import numpy as np

WIDTH, HEIGHT = 160, 120
HEADS = [(60, 50, 15), (80, 60, 18), (101, 47, 22), (45, 75, 14), (110, 70, 20)]
STARTS = [(8, 0), (-7, 5), (0, -9), (6, 7), (-3, -4)]


def frame(number):
    x0, y0, half = HEADS[number]
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    u, v = (x - x0) / (half / 1.2), (y - y0) / half
    grain = ((x * 7 + y * 13 + number * 5) % 11) - 5
    wall = np.stack([120 + (x // 16 + y // 12) % 3 * 12, 130 + (x // 20) % 2 * 10, 150 + 0 * x], axis=2)
    skin = np.stack([205 + 0 * x, 150 + 0 * x, 120 + 0 * x], axis=2)
    hair = np.stack([50 + 0 * x, 35 + 0 * x, 25 + 0 * x], axis=2)
    head = np.where(((x + y) // 3 % 3 == 0)[..., None], hair, skin)
    picture = np.where((u * u + v * v < 1)[..., None], head, wall) + grain[..., None]
    return picture.clip(0, 255).astype(np.uint8)


out = []
for number, ((x0, y0, half), (dx, dy)) in enumerate(zip(HEADS, STARTS)):
    picture = frame(number)
    bins = picture.astype(int) * 10 // 256
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    u, v = (x - x0) / (half / 1.2), (y - y0) / half
    kernel = np.maximum(1 - u * u - v * v, 0)
    flat = bins[..., 0] * 100 + bins[..., 1] * 10 + bins[..., 2]
    model = np.bincount(flat.ravel(), kernel.ravel(), 1000).astype(np.float32).reshape(10, 10, 10)
    back = cv2.calcBackProject([picture], [0, 1, 2], model, [0, 256] * 3, 255 / model.max())
    width, height = round(2 * half / 1.2), 2 * half
    window = (x0 + dx - width // 2, y0 + dy - height // 2, width, height)
    steps, (left, top, w, h) = cv2.meanShift(back, window, (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 20, 1))
    out.append({"start": [window[0] + width / 2, window[1] + height / 2], "end": [left + w / 2, top + h / 2], "steps": steps})
path = pathlib.Path(__file__).with_name("mean_shift.json")
path.write_text(json.dumps(out) + "\n")
print(path.read_text(), HEADS)
