#!/usr/bin/env python3
"""Makes tone.flac: 0.1 s of two channels at 16 kHz, 16 bits: 10000 sin(0.2 n) and its negative half, rounded.

    python3 -m venv .venv
    .venv/bin/pip install soundfile==0.13.1 numpy==2.4.6
    .venv/bin/python crates/hearsight-sim/tests/goldens/make_tone.py
"""

import pathlib

import numpy as np
import soundfile

tone = 10000 * np.sin(0.2 * np.arange(1600))
channels = np.round(np.stack([tone, -tone / 2], axis=1)).astype(np.int16)
soundfile.write(pathlib.Path(__file__).with_name("tone.flac"), channels, 16000, subtype="PCM_16")
