#!/usr/bin/env python3
"""Makes responses.json: impulse responses of pyroomacoustics that the acoustics are compared with.

    python3 -m venv .venv
    .venv/bin/pip install pyroomacoustics==0.10.1 numpy==2.4.6 scipy==1.17.1
    .venv/bin/python crates/hearsight-sim/tests/goldens/make_responses.py

Matching settings: its high-pass is off; no randomized images; 81 taps for fractional delays, which is its default. Its
amplitudes are 1 / distance, without the 4 pi of a point source: those of Hearsight, where 1 is the pressure at 1 m. Its
responses begin 40 samples before the emission.
"""

import json
import pathlib

import numpy as np
import pyroomacoustics as pra

pra.constants.set("rir_hpf_enable", False)
assert pra.constants.get("frac_delay_length") == 81

CASES = [
    {"name": "one absorption", "size_m": [4.0, 3.0, 2.5], "absorption": [0.3] * 6, "order": 7,
     "source_m": [1.1, 0.9, 1.6], "microphone_m": [2.9, 2.2, 1.1], "everywhere": 1.0},
    {"name": "six walls", "size_m": [5.0, 4.0, 3.0], "absorption": [0.1, 0.2, 0.3, 0.45, 0.6, 0.75], "order": 5,
     "source_m": [1.3, 2.9, 1.7], "microphone_m": [4.2, 1.25, 0.9], "everywhere": 1.0},
    {"name": "cardioid", "size_m": [4.0, 5.0, 2.7], "absorption": [0.4] * 6, "order": 4,
     "source_m": [2.1, 1.4, 1.5], "microphone_m": [1.2, 3.9, 1.3], "everywhere": 0.5, "azimuth_degrees": 40.0},
]


def response(case):
    walls = ["west", "east", "south", "north", "floor", "ceiling"]
    materials = {wall: pra.Material(share) for wall, share in zip(walls, case["absorption"])}
    room = pra.ShoeBox(case["size_m"], fs=16000, materials=materials, max_order=case["order"], air_absorption=False)
    directivity = None
    if case["everywhere"] < 1:
        facing = pra.directivities.DirectionVector(azimuth=case["azimuth_degrees"], colatitude=90, degrees=True)
        directivity = pra.directivities.Cardioid(facing)
    room.add_source(case["source_m"], directivity=directivity)
    room.add_microphone(case["microphone_m"])
    room.compute_rir()
    return room.rir[0][0]


def main():
    for case in CASES:
        case["rate_hz"], case["lead"] = 16000, 40
        case["samples"] = [float(f"{sample:.7g}") for sample in np.asarray(response(case), float)]
        print(case["name"], len(case["samples"]))
    file = pathlib.Path(__file__).with_name("responses.json")
    file.write_text(json.dumps({"pyroomacoustics": pra.__version__, "cases": CASES}) + "\n")


if __name__ == "__main__":
    main()
