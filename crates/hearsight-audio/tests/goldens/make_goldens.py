"""Makes goldens.json: windowed transforms, filter taps and correlation curves as scipy computes them.

Versions: numpy 1.26.4, scipy 1.17.1. Run as `python make_goldens.py`; it writes beside itself.
"""

import json
from pathlib import Path

import numpy as np
import scipy.fft
import scipy.signal

RATE_HZ = 16000
LENGTH, PADDED, FACTOR, HALF, FRAMES = 128, 256, 4, 42, 6
FORGETTING, GAMMA, REVERBERATION = 0.8, 0.4, 0.3


def rounded(values):
    return [float(f"{value:.7g}") for value in np.asarray(values).ravel()]


def spectrum(frame, window):
    return scipy.fft.rfft(frame * scipy.signal.get_window(window, LENGTH), PADDED)


def curve(weighted):
    """The weighted cross-spectrum as a curve FACTOR values a sample, HALF of them on each side of 0."""
    padded = np.zeros(PADDED * FACTOR // 2 + 1, dtype=complex)
    padded[: PADDED // 2 + 1] = weighted
    padded[PADDED // 2] *= 0.5
    lags = scipy.fft.irfft(padded) * FACTOR
    return np.concatenate([lags[-HALF:], lags[: HALF + 1]])


def main():
    random = np.random.default_rng(20240521)
    source = random.normal(size=LENGTH * FRAMES + 8)
    first = 0.1 * source[3 : 3 + LENGTH * FRAMES] + 0.02 * random.normal(size=LENGTH * FRAMES)
    second = 0.08 * source[8 : 8 + LENGTH * FRAMES] + 0.03 * random.normal(size=LENGTH * FRAMES)
    first, second = (np.array(rounded(channel.round(5))) for channel in (first, second))
    frames = [(first[k : k + LENGTH], second[k : k + LENGTH]) for k in range(0, LENGTH * FRAMES, LENGTH)]

    bins = np.arange(PADDED // 2 + 1)
    noises = 0.05 + 0.0005 * bins, 0.12 - 0.0004 * bins
    x, y = (spectrum(channel, "hann") for channel in frames[0])
    cross, power_x, power_y = x * y.conj(), abs(x) ** 2, abs(y) ** 2
    single = {
        "plain": cross,
        "phat": cross / abs(cross),
        "maximum_likelihood": cross * np.sqrt(power_x * power_y)
        / (2 * REVERBERATION * power_x * power_y
           + (1 - REVERBERATION) * (noises[1] * power_x + noises[0] * power_y)),
        "noise_regularized": cross / (GAMMA * abs(cross) + (1 - GAMMA) * np.sqrt(noises[0] * noises[1])),
    }

    average = None
    for pair in frames:
        x, y = (spectrum(channel, "hann") for channel in pair)
        terms = x * y.conj(), abs(x) ** 2, abs(y) ** 2
        average = terms if average is None else [
            FORGETTING * old + (1 - FORGETTING) * new for old, new in zip(average, terms)
        ]
    cross, power_x, power_y = average
    coherence = np.minimum(abs(cross) ** 2 / (power_x * power_y), 0.999)
    averaged = {
        "scot": cross / np.sqrt(power_x * power_y),
        "coherence": cross / abs(cross) * coherence / (1 - coherence),
    }

    goldens = {
        "rate_hz": RATE_HZ, "padded": PADDED, "factor": FACTOR, "half": HALF, "length": LENGTH,
        "forgetting": FORGETTING, "gamma": GAMMA, "reverberation": REVERBERATION,
        "first": rounded(first), "second": rounded(second),
        "noises": [rounded(noise) for noise in noises],
        "spectra": {
            name: [rounded(values.real), rounded(values.imag)]
            for name, values in ((name, spectrum(frames[0][0], window)) for name, window in
                                 (("hann", "hann"), ("hamming", "hamming"), ("rectangular", "boxcar")))
        },
        "curves": {name: rounded(curve(values)) for name, values in single.items()},
        "averaged_curves": {name: rounded(curve(values)) for name, values in averaged.items()},
        # Order 36: 37 taps; the third is a high-pass.
        "taps": [
            rounded(scipy.signal.firwin(37, 1500, fs=12000, window="hamming")),
            rounded(scipy.signal.firwin(37, [1500, 3600], fs=12000, window="hamming", pass_zero=False)),
            rounded(scipy.signal.firwin(37, 3600, fs=12000, window="hamming", pass_zero=False)),
        ],
    }
    text = json.dumps(goldens, separators=(",", ":"))
    Path(__file__).with_name("goldens.json").write_text(text + "\n")


if __name__ == "__main__":
    main()
