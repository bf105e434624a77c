#!/usr/bin/env python3
"""Measures what Hearsight does and the same of OpenCV, scipy, numpy and filterpy, in turn, on one thread each.

    python3 -m venv .venv
    .venv/bin/pip install opencv-python-headless==4.10.0.84 numpy==1.26.4 scipy==1.17.1 filterpy==2.0.0
    .venv/bin/python benches/compare.py [--rounds 25] [--only TEXT] [--video FILE] [--program FILE] [--strict]

Builds the program `one` (release) and lets it answer in turn with the other library: A B A B ... Time is processor
time of the one thread, so that other programs on the machine disturb little; what they do to the caches remains.
A ratio above 1 means that Hearsight is faster. `median` is the median over the rounds of the ratio of a round's two
times; `least` is the ratio of the least times of both. Pictures are those of a recording where there is one, else
noise and blocks; both sides get the same bytes. `--strict` ends with 1 where a ratio asked for is missed.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import cv2
import numpy as np
import scipy.fft
from filterpy.monte_carlo import systematic_resample

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIDEO = ROOT.parent / "shared/data/av16.3-seq30/seq30-2p-1101_cam1_divx_audio.avi"
CASCADES = pathlib.Path("/usr/share/opencv4/haarcascades")
PICTURES = 8
# Another method, or other random numbers: results need not agree.
DIFFERENT = {"background", "particle_step"}

cv2.setNumThreads(1)


def pictures(video):
    """Eight colour pictures (RGB) from all over a recording, or made up; and their grey ones."""
    found = []
    if video.is_file():
        capture = cv2.VideoCapture(str(video))
        frames = int(capture.get(cv2.CAP_PROP_FRAME_COUNT))
        # Pairs of neighbours: change is looked for between one picture and the next.
        wanted = {int(frames * (2 * part + 1) / PICTURES) + next for part in range(PICTURES // 2) for next in (0, 1)}
        for number in range(frames):
            good, picture = capture.read()
            if good and number in wanted:
                found.append(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))
    if len(found) < PICTURES:
        random = np.random.default_rng(1)
        for number in range(PICTURES):
            picture = random.integers(100, 116, (288, 360, 3)).astype(np.uint8)
            picture[60:250, 90 + 14 * number:150 + 14 * number] //= 2
            found.append(picture)
        found = found[-PICTURES:]
    return found, [cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY) for picture in found]


def in_turn(pictures, work):
    """`work` on one picture after the other, with the one before it."""
    number = 0

    def call():
        nonlocal number
        before = pictures[number % len(pictures)]
        number += 1
        return work(pictures[number % len(pictures)], before)

    return call


def integral(grey, width, height):
    table = np.empty((height + 1, width + 1), np.int32)
    pictures = [np.ascontiguousarray(picture[:height, :width]) for picture in grey]
    return in_turn(pictures, lambda picture, _: cv2.integral(picture, table)[-1, -1])


def squares(grey, width, height):
    table, square = np.empty((height + 1, width + 1), np.int32), np.empty((height + 1, width + 1))
    pictures = [np.ascontiguousarray(picture[:height, :width]) for picture in grey]
    return in_turn(pictures, lambda picture, _: cv2.integral2(picture, table, square)[1][-1, -1])


def tilted(grey):
    return in_turn(grey, lambda picture, _: cv2.integral3(picture)[0][-1, -1])


def change(rgb, threshold_first):
    """The chain in two orders that give the same mask: threshold each channel or the largest of them."""
    element = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (15, 5))
    difference, shape = np.empty_like(rgb[0]), rgb[0].shape[:2]
    red, green, blue, mask, clean = (np.empty(shape, np.uint8) for _ in range(5))

    def work(picture, before):
        cv2.absdiff(picture, before, difference)
        if threshold_first:
            cv2.threshold(difference, 20, 255, cv2.THRESH_BINARY, difference)
        cv2.split(difference, [red, green, blue])
        unite = cv2.bitwise_or if threshold_first else cv2.max
        unite(red, green, mask)
        unite(mask, blue, mask)
        if not threshold_first:
            cv2.threshold(mask, 20, 255, cv2.THRESH_BINARY, mask)
        cv2.medianBlur(mask, 5, clean)
        return cv2.countNonZero(cv2.dilate(clean, element, mask))

    return in_turn(rgb, work)


def background(rgb):
    model = cv2.createBackgroundSubtractorMOG2(detectShadows=True)
    return in_turn(rgb, lambda picture, _: cv2.countNonZero(model.apply(picture)))


def faces(grey, name):
    cascade = cv2.CascadeClassifier(str(CASCADES / f"haarcascade_frontalface_{name}.xml"))
    return in_turn(grey, lambda picture, _: len(cascade.detectMultiScale(picture, 1.1, 3, minSize=(20, 20))))


def phase_transform(together):
    random = np.random.default_rng(1)
    common = random.uniform(-1, 1, 4096 + 7).astype(np.float32)
    first = common[:4096] + 0.3 * random.uniform(-1, 1, 4096).astype(np.float32)
    second = common[7:] + 0.3 * random.uniform(-1, 1, 4096).astype(np.float32)
    both = np.stack([first, second])
    tiny, half = np.float32(1e-20), 50

    def call():
        if together:
            x, y = scipy.fft.rfft(both, 8192)
        else:
            x, y = scipy.fft.rfft(first, 8192), scipy.fft.rfft(second, 8192)
        cross = x * np.conj(y)
        cross /= np.maximum(np.abs(cross), tiny)
        curve = scipy.fft.irfft(cross, 8192)
        lags = np.concatenate([curve[-half:], curve[:half + 1]])
        return (int(np.argmax(lags)) - half) / 16000

    assert scipy.fft.rfft(first, 8192).dtype == np.complex64
    return call


def particle_step():
    random = np.random.default_rng(1)
    np.random.seed(1)
    states, sigma = random.standard_normal((1000, 6)), 0.5 * 0.04**0.5

    def call():
        nonlocal states
        states = states + sigma * random.standard_normal(states.shape)
        log_weights = -2.0 * (states[:, :3] ** 2).sum(axis=1)
        weights = np.exp(log_weights - log_weights.max())
        weights /= weights.sum()
        chosen = systematic_resample(weights)
        states = states[chosen]
        return chosen[0]

    return call


def pairs(rgb, grey):
    """(our work, the other library's, calls a round, ratio asked for, other work)"""
    sizes = [(320, 240), (360, 288)]
    return [
        *((f"integral_{w}x{h}", "OpenCV integral", 1600, 1, lambda w=w, h=h: integral(grey, w, h)) for w, h in sizes),
        *((f"squares_{w}x{h}", "OpenCV integral2", 480, None, lambda w=w, h=h: squares(grey, w, h)) for w, h in sizes),
        ("tilted_360x288", "OpenCV integral3", 160, None, lambda: tilted(grey)),
        ("change", "OpenCV, thresholds then OR", 80, 1, lambda: change(rgb, True)),
        ("change", "OpenCV, maximum then threshold", 80, 1, lambda: change(rgb, False)),
        ("background", "OpenCV MOG2 (other method)", 40, None, lambda: background(rgb)),
        ("faces_alt2", "OpenCV detectMultiScale", 8, 1, lambda: faces(grey, "alt2")),
        ("faces_default", "OpenCV detectMultiScale", 8, 1, lambda: faces(grey, "default")),
        ("phat_8192", "scipy, a transform a channel", 200, 3, lambda: phase_transform(False)),
        ("phat_8192", "scipy, both in one call", 200, 3, lambda: phase_transform(True)),
        ("particle_step", "numpy and filterpy", 80, 15, particle_step),
    ]


def build():
    """Builds `one` and says where it is."""
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "hearsight-benches"], cwd=ROOT, check=True)
    metadata = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1"], cwd=ROOT, check=True, stdout=subprocess.PIPE)
    return pathlib.Path(json.loads(metadata.stdout)["target_directory"]) / "release/one"


class One:
    """Our side, in a process of its own that waits while the other side works."""

    def __init__(self, program, rgb, grey, directory):
        files = [pathlib.Path(directory) / name for name in ("rgb", "grey")]
        for file, pictures in zip(files, (rgb, grey)):
            file.write_bytes(np.stack(pictures).tobytes())
        height, width = grey[0].shape
        command = [program, "--pictures", *files, width, height]
        self.process = subprocess.Popen(
            list(map(str, command)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def measure(self, name, count):
        self.process.stdin.write(f"{name} {count}\n")
        return json.loads(self.process.stdout.readline())


def measure(call, count):
    """Nanoseconds a call of this thread's processor time, and the sum of what the calls return."""
    total, begun = 0.0, time.thread_time_ns()
    for _ in range(count):
        total += call()
    return (time.thread_time_ns() - begun) / count, total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=25)
    parser.add_argument("--only", default="", help="pairs whose name contains this")
    parser.add_argument("--video", type=pathlib.Path, default=VIDEO)
    parser.add_argument("--program", type=pathlib.Path, help="`one`, built before")
    parser.add_argument("--strict", action="store_true")
    arguments = parser.parse_args()
    rgb, grey = pictures(arguments.video)
    source = arguments.video.name if arguments.video.is_file() else "made-up pictures"
    height, width = grey[0].shape
    print(f"{len(grey)} pictures of {width} x {height} from {source}; OpenCV {cv2.__version__}, scipy "
          f"{scipy.__version__}, numpy {np.__version__}; load {os.getloadavg()[0]:.1f}; processor time a call, us")
    print(f"{'work':<17} {'beside':<31} {'ours':>8} {'theirs':>8} {'median':>7} {'least':>7} {'asked':>6}  same result")
    missed = False
    with tempfile.TemporaryDirectory() as directory:
        one = One(arguments.program or build(), rgb, grey, directory)
        for name, beside, count, asked, prepare in pairs(rgb, grey):
            if arguments.only not in name:
                continue
            first = one.measure(name, count)
            if "skipped" in first:
                print(f"{name:<17} skipped: {first['skipped']}")
                continue
            call = prepare()
            measure(call, count)
            ours, theirs, results = [], [], set()
            for _ in range(arguments.rounds):
                mine = one.measure(name, count)
                other, result = measure(call, count)
                ours.append(mine["cpu_ns"])
                theirs.append(other)
                results.add((mine["result"], result))
            ratio = statistics.median(b / a for a, b in zip(ours, theirs))
            least = min(theirs) / min(ours)
            same = "yes" if all(abs(a - b) <= 1e-6 * abs(b) for a, b in results) else "no"
            same = "-" if name in DIFFERENT else same
            missed |= asked is not None and ratio < asked
            print(f"{name:<17} {beside:<31} {statistics.median(ours) / 1e3:8.1f} {statistics.median(theirs) / 1e3:8.1f} "
                  f"{ratio:7.2f} {least:7.2f} {asked or '':>6}  {same}", flush=True)
    return 1 if missed and arguments.strict else 0


if __name__ == "__main__":
    sys.exit(main())
