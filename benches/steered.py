#!/usr/bin/env python3
"""Measures the steered response beside numpy and pyroomacoustics, in one run, on signals of a simulated room.

    python3 -m venv .venv
    .venv/bin/pip install numpy==1.26.4 scipy==1.17.1 pyroomacoustics==0.10.1
    .venv/bin/python benches/steered.py [--rounds 20] [--frames 12] [--strict]

Eight microphones on a table, 28 pairs, frames of 4096 samples at 16 kHz, T60 0.3 s, 20 dB of noise, a grid of 10,000
points over the room. Noise bursts and the six sentences of CMU Arctic, where they are there, sound from places all
over the room. All sides get the same frames and the same grid:

* numpy: correlations interpolated 16 times by the inverse transform, then looked up at the nearest value for all
  points at once, with places found beforehand; the look-up alone is what is compared, and the whole beside it;
* pyroomacoustics: its dense SRP-PHAT on the same grid, whose steering vectors it makes beforehand too;
* Hearsight: `steered`, transforms, curves of all pairs, and the grid apart.

Time is processor time of one thread. `--strict` ends with 1 where the look-up is not five times as fast as numpy's or
the error is larger than pyroomacoustics'.
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

import numpy as np
import pyroomacoustics as pra
import scipy.io.wavfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SPEECH = ROOT.parent / "shared/data/speech"
RATE, LENGTH, SPEED = 16000, 4096, 343.0
ROOM = np.array([5.0, 4.0, 2.5])
STEP = (5.0 * 4.0 * 2.5 / 10_000) ** (1 / 3)


def array():
    """A circle of eight, every second one raised: it hears the height as well."""
    angle = 2 * np.pi * np.arange(8) / 8
    ring = np.stack([0.25 * np.cos(angle), 0.25 * np.sin(angle), np.where(np.arange(8) % 2, 0.15, 0.0)])
    return ring + np.array([[2.4], [1.9], [0.8]])


def sentences():
    found = []
    for file in sorted(SPEECH.glob("*.wav")):
        rate, samples = scipy.io.wavfile.read(file)
        if rate == RATE:
            found.append(samples / 32768.0)
    return found


def frames(count, microphones):
    """Frames x microphones x samples, and where the source of each is."""
    random = np.random.default_rng(3)
    np.random.seed(3)  # pyroomacoustics draws its noise from here: without, every run is of other frames
    texts, made, places = sentences(), [], []
    while len(made) < count:
        place = random.uniform([0.4, 0.4, 0.8], ROOM - [0.4, 0.4, 0.6])
        if np.linalg.norm(place - microphones.mean(axis=1)) < 0.8:
            continue
        if texts:
            text = texts[len(made) % len(texts)]
            loud = np.convolve(text ** 2, np.ones(LENGTH), "valid").argmax()
            start = max(0, loud - LENGTH)
            signal = text[start:start + 4 * LENGTH]
        else:
            signal = random.standard_normal(4 * LENGTH) * np.repeat(random.uniform(0.2, 1, 16), LENGTH // 4)
        absorption, order = pra.inverse_sabine(0.3, ROOM)
        room = pra.ShoeBox(ROOM, fs=RATE, materials=pra.Material(absorption), max_order=order)
        room.add_source(place, signal=signal)
        room.add_microphone_array(microphones)
        room.simulate(snr=20, reference_mic=0)
        heard = room.mic_array.signals
        power = np.convolve((heard[0] ** 2)[:len(signal)], np.ones(LENGTH), "valid")
        start = int(power.argmax())
        made.append(heard[:, start:start + LENGTH].astype(np.float32))
        places.append(place)
    return np.stack(made), np.array(places)


def grid():
    counts = np.maximum(np.ceil(ROOM / STEP - 1e-9), 1).astype(int)
    axes = [side * (np.arange(n) + 0.5) / n for side, n in zip(ROOM, counts)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()])


class Numpy:
    """The usual way: a table of interpolated correlations, looked up at the nearest value."""

    FACTOR = 16

    def __init__(self, microphones, points):
        count = microphones.shape[1]
        self.pairs = [(i, j) for i in range(count) for j in range(i + 1, count)]
        distance = np.linalg.norm(points[None] - microphones.T[:, :, None], axis=1)
        delay = np.array([distance[i] - distance[j] for i, j in self.pairs]) / SPEED
        self.half = int(np.ceil(np.abs(delay).max() * RATE)) + 2
        self.places = np.round(delay * RATE * self.FACTOR).astype(np.int32) + self.half * self.FACTOR
        self.rows = np.arange(len(self.pairs))[:, None]
        self.window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(LENGTH) / LENGTH)

    def curves(self, frame):
        spectra = np.fft.rfft(frame * self.window, 2 * LENGTH)
        spectra /= np.maximum(np.abs(spectra), 1e-12)
        table = []
        for i, j in self.pairs:
            lags = np.fft.irfft(spectra[i] * spectra[j].conj(), 2 * LENGTH * self.FACTOR)
            side = self.half * self.FACTOR
            table.append(np.concatenate([lags[-side:], lags[:side + 1]]))
        return np.array(table, np.float32)

    def look_up(self, table):
        return table[self.rows, self.places].sum(axis=0)


def timed(work):
    start = time.thread_time_ns()
    result = work()
    return time.thread_time_ns() - start, result


def error(found, places, centre):
    """Median distance and median angle seen from the array."""
    away = np.linalg.norm(found - places, axis=1)
    a, b = found - centre, places - centre
    cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    return float(np.median(away)), float(np.median(np.degrees(np.arccos(np.clip(cosine, -1, 1)))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--slow", type=int, default=12, help="frames for pyroomacoustics, half a minute each; the median of "
                        "a few is the luck of one: next points of the grid are within 1 % of the best")
    parser.add_argument("--program", type=pathlib.Path)
    parser.add_argument("--strict", action="store_true")
    arguments = parser.parse_args()
    program = arguments.program
    if program is None:
        subprocess.run(["cargo", "build", "--release", "-p", "hearsight-benches", "--bin", "steered"], cwd=ROOT, check=True)
        program = ROOT / "target/release/steered"

    microphones, points = array(), grid()
    heard, places = frames(arguments.frames, microphones)
    centre = microphones.mean(axis=1)
    print(f"{points.shape[1]} points, {len(heard)} frames of {LENGTH} samples, 8 microphones, 28 pairs")

    numpy = Numpy(microphones, points)
    with tempfile.TemporaryDirectory() as directory:
        specification, samples = pathlib.Path(directory) / "room.txt", pathlib.Path(directory) / "frames.f32"
        lines = [f"rate {RATE} length {LENGTH}", f"bounds 0 0 0 {ROOM[0]} {ROOM[1]} {ROOM[2]} step {STEP!r}"]
        lines += [" ".join(map(repr, map(float, position))) for position in microphones.T]
        specification.write_text("\n".join(lines) + "\n")
        heard.astype("<f4").tofile(samples)
        look_ups, curves, ours, found_by_numpy = [], [], [], []
        for number in range(arguments.rounds):
            spent = [0, 0]
            for frame in heard:
                took, table = timed(lambda: numpy.curves(frame))
                spent[0] += took
                took, scores = timed(lambda: numpy.look_up(table))
                spent[1] += took
                if number == 0:
                    found_by_numpy.append(points[:, scores.argmax()])
            curves.append(spent[0] / len(heard))
            look_ups.append(spent[1] / len(heard))
            command = [program, specification, samples, "1"]
            ours.append(json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout))

    found_by_pra, pra_ns = pyroomacoustics(heard[:arguments.slow], microphones, points)

    median = lambda key: statistics.median(answer[key] for answer in ours)
    table, whole = median("table"), median("transforms") + median("curves") + median("table")
    ratio = statistics.median(a / b["table"] for a, b in zip(look_ups, ours))
    show = lambda name, ns: print(f"  {name:<46} {ns / 1e6:10.3f} ms a frame")
    show("numpy, look-up of 10,000 points", statistics.median(look_ups))
    show("numpy, transforms and interpolated correlations", statistics.median(curves))
    show("pyroomacoustics, dense SRP-PHAT", pra_ns)
    show("hearsight, grid", table)
    show("hearsight, transforms (shared)", median("transforms"))
    show("hearsight, curves of 28 pairs (shared)", median("curves"))
    show("hearsight, 500 particles", median("particles"))
    show(f"hearsight, search from {ours[0]['coarse_points']} coarse points", median("search"))
    whole_ratio = (statistics.median(look_ups) + statistics.median(curves)) / whole
    print(f"look-up: {ratio:.1f} times as fast as numpy's; with transforms and curves {whole_ratio:.1f} times;")
    print(f"numpy's look-up alone against all of ours, transforms included: {statistics.median(look_ups) / whole:.1f} times")
    found = np.array([answer for answer in ours[0]["found"]])
    errors = {
        "numpy": error(np.array(found_by_numpy), places, centre),
        "hearsight, grid": error(found[:, 0], places, centre),
        "hearsight, search": error(found[:, 1], places, centre),
        "pyroomacoustics, first frames": error(found_by_pra, places[:len(found_by_pra)], centre),
        "hearsight, grid, same frames": error(found[:len(found_by_pra), 0], places[:len(found_by_pra)], centre),
        "hearsight, search, same frames": error(found[:len(found_by_pra), 1], places[:len(found_by_pra)], centre),
    }
    for name, (distance, angle) in errors.items():
        print(f"  {name:<34} median error {distance:.3f} m, {angle:.2f} degrees")
    missed = []
    if ratio < 5:
        missed.append(f"the look-up is {ratio:.1f} times as fast as numpy's, not 5")
    if errors["hearsight, grid, same frames"][0] > errors["pyroomacoustics, first frames"][0] + 1e-9:
        missed.append("the error on the grid is larger than pyroomacoustics'")
    for sentence in missed:
        print(f"missed: {sentence}")
    return 1 if arguments.strict and missed else 0


class Points:
    """A grid of any points: pyroomacoustics' own hold directions only."""

    def __init__(self, count):
        self.n_points, self.values = count, None

    def set_values(self, values):
        self.values = values


def pyroomacoustics(heard, microphones, points):
    """Its SRP-PHAT, `pra.doa.SRP._process`, over points instead of directions: we give it steering vectors of spherical
    waves, in parts, since those of 10,000 points fill five gigabytes. Making them is not counted."""
    srp = pra.doa.SRP(microphones, RATE, 2 * LENGTH, c=SPEED, num_src=1, n_grid=4)
    bins = np.arange(75, 3769)
    srp.freq_bins, srp.num_freq = np.arange(len(bins)), len(bins)
    omega = 2 * np.pi * bins * RATE / (2 * LENGTH)
    distance = np.linalg.norm(points.T[:, None] - microphones.T[None], axis=2)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(LENGTH) / LENGTH)
    best, spent = [], 0
    for frame in heard:
        spectra = np.fft.rfft(frame * window, 2 * LENGTH)[:, bins][:, :, None]
        srp.num_snap, power = 1, []
        for part in np.array_split(np.arange(points.shape[1]), 100):
            srp.grid = Points(len(part))
            srp.mode_vec = np.exp(-1j * omega[:, None, None] * (distance[part].T / SPEED)[None])
            took, _ = timed(lambda: srp._process(spectra))
            spent += took
            power.append(srp.grid.values)
        best.append(points[:, np.concatenate(power).argmax()])
    return np.array(best), spent / len(heard)


if __name__ == "__main__":
    sys.exit(main())
