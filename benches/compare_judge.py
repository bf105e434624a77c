#!/usr/bin/env python3
"""Measures the judge of Hearsight beside TrackEval on the same files, in turn, on one thread each.

    python3 -m venv .venv
    .venv/bin/pip install trackeval==1.3.0 numpy==2.4.6 scipy==1.17.1
    .venv/bin/python benches/compare_judge.py [--rounds 9] [--people 20] [--frames 5000] [--program FILE] [--strict]

Builds the program `judge` (release). The files are made up: people walk through a picture, their tracks waver, are
missed now and then, exchange their numbers, and there are false ones. Both sides read MOTChallenge text and compute
CLEAR, identity and HOTA, from the files to the values; TrackEval loads as its MotChallenge2DBox does, without
preprocessing. What either needs to start is not counted. Time is processor time. A ratio above 1 means that Hearsight is
faster; `median` is over the rounds, `least` the ratio of the least times. HOTA and IDF1 must agree to 1e-6; MOTA is that
of motmetrics, which goes on with a pair also after a gap.
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
import trackeval

ROOT = pathlib.Path(__file__).resolve().parent.parent
ASKED = 30


def make(directory, people, frames):
    """Truth and tracks as TrackEval wants its directories; returns both files."""
    random = np.random.default_rng(1)
    truth = directory / "truth/walk/gt/gt.txt"
    tracks = directory / "tracks/ours/data/walk.txt"
    for file in (truth, tracks):
        file.parent.mkdir(parents=True)
    places = random.uniform((0, 0), (1800, 900), (people, 2))
    numbers = np.arange(1, people + 1)
    with truth.open("w") as of_truth, tracks.open("w") as of_tracks:
        for frame in range(1, frames + 1):
            places = np.clip(places + random.normal(0, 4, places.shape), 0, (1800, 900))
            if random.random() < 0.02:
                one, other = random.choice(people, 2, replace=False)
                numbers[[one, other]] = numbers[[other, one]]
            seen = places + random.normal(0, 5, places.shape)
            for person, (x, y) in enumerate(places):
                of_truth.write(f"{frame},{person + 1},{x:.2f},{y:.2f},60,120,1,1,1\n")
                if random.random() > 0.1:
                    x, y = seen[person]
                    of_tracks.write(f"{frame},{numbers[person]},{x:.2f},{y:.2f},60,120,0.9,-1,-1,-1\n")
            for number in range(random.poisson(0.05 * people)):
                x, y = random.uniform((0, 0), (1800, 900))
                of_tracks.write(f"{frame},{people + 1 + number},{x:.2f},{y:.2f},60,120,0.5,-1,-1,-1\n")
    return truth, tracks


def theirs(directory, frames):
    """Seconds of processor time and what came out."""
    begun = time.process_time()
    data = trackeval.datasets.MotChallenge2DBox({
        "GT_FOLDER": str(directory / "truth"), "TRACKERS_FOLDER": str(directory / "tracks"),
        "TRACKERS_TO_EVAL": ["ours"], "SKIP_SPLIT_FOL": True, "SEQ_INFO": {"walk": frames}, "DO_PREPROC": False,
        "PRINT_CONFIG": False})
    raw = data.get_raw_seq_data("ours", "walk")
    prepared = data.get_preprocessed_seq_data(raw, "pedestrian")
    values = {}
    for metric in (trackeval.metrics.CLEAR({"PRINT_CONFIG": False}), trackeval.metrics.HOTA(),
                   trackeval.metrics.Identity({"PRINT_CONFIG": False})):
        values |= metric.eval_sequence(prepared)
    return time.process_time() - begun, {
        "HOTA": float(np.mean(values["HOTA"])), "idf1": float(values["IDF1"]), "mota": float(values["MOTA"])}


class Judge:
    """Our side, in a process of its own that judges once before it is measured."""

    def __init__(self, program, truth, tracks):
        self.command = [str(part) for part in (program, truth, tracks, 2)]

    def measure(self):
        lines = subprocess.run(self.command, check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
        found = json.loads(lines[-1])
        return found.pop("cpu_ns") / 1e9, found


def build():
    """Builds `judge` and says where it is."""
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "hearsight-benches"], cwd=ROOT, check=True)
    metadata = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1"], cwd=ROOT, check=True, stdout=subprocess.PIPE)
    return pathlib.Path(json.loads(metadata.stdout)["target_directory"]) / "release/judge"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--people", type=int, default=20)
    parser.add_argument("--frames", type=int, default=5000)
    parser.add_argument("--program", type=pathlib.Path, help="`judge`, built before")
    parser.add_argument("--strict", action="store_true", help="end with 1 where the ratio or the values are missed")
    arguments = parser.parse_args()
    program = arguments.program or build()
    mine, other = [], []
    with tempfile.TemporaryDirectory() as directory:
        directory = pathlib.Path(directory)
        truth, tracks = make(directory, arguments.people, arguments.frames)
        judge = Judge(program, truth, tracks)
        for _ in range(arguments.rounds):
            seconds, values = judge.measure()
            mine.append(seconds)
            seconds, reference = theirs(directory, arguments.frames)
            other.append(seconds)
    ratio = statistics.median(b / a for a, b in zip(mine, other))
    same = all(abs(values[name] - reference[name]) < 1e-6 for name in ("HOTA", "idf1"))
    print(f"{arguments.people} people, {arguments.frames} frames; numpy {np.__version__}; load {os.getloadavg()[0]:.1f}")
    print(f"Hearsight {statistics.median(mine) * 1e3:8.1f} ms {values}")
    print(f"TrackEval {statistics.median(other) * 1e3:8.1f} ms {reference}")
    print(f"ratio: median {ratio:.1f}, least {min(other) / min(mine):.1f}, asked {ASKED}; same HOTA and IDF1: "
          f"{'yes' if same else 'no'}")
    return 1 if arguments.strict and not (same and ratio >= ASKED) else 0


if __name__ == "__main__":
    sys.exit(main())
