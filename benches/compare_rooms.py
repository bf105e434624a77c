#!/usr/bin/env python3
"""Measures impulse responses of Hearsight and of pyroomacoustics, in turn, on one thread each.

    python3 -m venv .venv
    .venv/bin/pip install pyroomacoustics==0.10.1 numpy==2.4.6 scipy==1.17.1
    .venv/bin/python benches/compare_rooms.py [--rounds 15] [--program FILE] [--strict]

Beside `compare.py`, in a file of its own since it needs another numpy. The room is 6 x 5 x 3 m with walls that absorb
35 % (T60 about 0.5 s), order 66, 16 kHz, 81 taps a fractional delay; images are not randomized and nothing is filtered.
Time is processor time of the whole process, since pyroomacoustics works in a thread of its own. A ratio above 1 means
that Hearsight is faster; `median` is over the rounds, `least` the ratio of the least times. Results are the energies of
the responses; they are the same where they differ by less than 0.5 % (its sinc is interpolated in a coarse table).
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "PRA_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import pyroomacoustics as pra

ROOT = pathlib.Path(__file__).resolve().parent.parent

pra.constants.set("rir_hpf_enable", False)
pra.constants.set("num_threads", 1)


def room():
    made = pra.ShoeBox([6, 5, 3], fs=16000, materials=pra.Material(0.35), max_order=66, air_absorption=False)
    made.add_source([1.2, 3.1, 1.6])
    made.add_microphone([4.4, 1.7, 1.1])
    return made


def energy(made):
    return float(np.sum(made.rir[0][0].astype(float) ** 2))


def response():
    made = room()
    made.compute_rir()
    return energy(made)


def again():
    made = room()
    made.image_source_model()

    def call():
        made.compute_rir()
        return energy(made)

    return call


def pairs():
    """(our work, what it is beside, calls a round, ratio asked for, other work)"""
    return [
        ("room_response", "room, images and response", 3, 3, response),
        ("room_response_again", "response, images known", 6, 3, again()),
    ]


def build():
    """Builds `one` and says where it is."""
    subprocess.run(["cargo", "build", "--release", "--locked", "-q", "-p", "hearsight-benches"], cwd=ROOT, check=True)
    metadata = subprocess.run(
        ["cargo", "metadata", "--no-deps", "--format-version", "1"], cwd=ROOT, check=True, stdout=subprocess.PIPE)
    return pathlib.Path(json.loads(metadata.stdout)["target_directory"]) / "release/one"


class One:
    """Our side, in a process of its own that waits while the other side works."""

    def __init__(self, program):
        self.process = subprocess.Popen(
            [str(program)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def measure(self, name, count):
        self.process.stdin.write(f"{name} {count}\n")
        return json.loads(self.process.stdout.readline())


def measure(call, count):
    """Nanoseconds a call of this process's processor time, and the sum of what the calls return."""
    total, begun = 0.0, time.process_time_ns()
    for _ in range(count):
        total += call()
    return (time.process_time_ns() - begun) / count, total


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--program", type=pathlib.Path, help="`one`, built before")
    parser.add_argument("--strict", action="store_true")
    arguments = parser.parse_args()
    print(f"pyroomacoustics {pra.__version__}, numpy {np.__version__}; load {os.getloadavg()[0]:.1f}; "
          "processor time a call, ms")
    print(f"{'work':<20} {'beside':<26} {'ours':>8} {'theirs':>8} {'median':>7} {'least':>7} {'asked':>6}  same result")
    one, missed = One(arguments.program or build()), False
    for name, beside, count, asked, call in pairs():
        one.measure(name, count)
        measure(call, 1)
        ours, theirs, results = [], [], set()
        for _ in range(arguments.rounds):
            mine = one.measure(name, count)
            other, result = measure(call, count)
            ours.append(mine["cpu_ns"])
            theirs.append(other)
            results.add((mine["result"], result))
        ratio = statistics.median(b / a for a, b in zip(ours, theirs))
        least = min(theirs) / min(ours)
        same = "yes" if all(abs(a - b) <= 5e-3 * abs(b) for a, b in results) else "no"
        missed |= ratio < asked or same == "no"
        print(f"{name:<20} {beside:<26} {statistics.median(ours) / 1e6:8.1f} {statistics.median(theirs) / 1e6:8.1f} "
              f"{ratio:7.2f} {least:7.2f} {asked:>6}  {same}", flush=True)
    return 1 if missed and arguments.strict else 0


if __name__ == "__main__":
    sys.exit(main())
