#!/usr/bin/env python3
"""What scipy says of small experiments: statistics.json.

    pip install numpy==2.4.6 scipy==1.17.1
    python make_statistics.py > statistics.json
"""

import json

import numpy as np
from scipy import stats

ALTERNATIVES = ("two-sided", "greater", "less")
random = np.random.default_rng(20)


def tests():
    for count in (1, 2, 5, 7, 12, 13, 20, 35, 50, 51, 80, 300):
        for ties in (False, True):
            values = random.normal(0.25, 1.0, count)
            if ties:
                values = np.round(values, 1)
            if ties and 13 < np.count_nonzero(values) <= 50:
                continue  # scipy takes these as normal; here they are counted out
            values = np.round(values, 4)
            above, below, kept = int((values > 0).sum()), int((values < 0).sum()), values[values != 0]
            method = stats.PermutationMethod(n_resamples=1 << 20) if ties and 2 <= len(kept) <= 13 else "auto"

            def p(alternative):
                if not len(kept):
                    return [1.0, 1.0]
                rank = stats.wilcoxon(kept, alternative=alternative, correction=False, method=method)
                sign = stats.binomtest(above, above + below, 0.5, alternative=alternative)
                return [float(sign.pvalue), float(rank.pvalue)]

            yield {"values": values.tolist()} | {alternative: p(alternative) for alternative in ALTERNATIVES}


def intervals():
    for count, skewed in ((6, False), (20, False), (20, True), (60, True)):
        values = random.lognormal(0, 0.8, count) if skewed else random.normal(3, 1, count)
        other = 2 + random.gamma(2.0, 1.0, count) + 0.3 * values
        options = {"n_resamples": 400_000, "method": "BCa", "batch": 10_000, "rng": np.random.default_rng(1)}
        mean = stats.bootstrap((values,), np.mean, **options).confidence_interval
        ratio = stats.bootstrap((values, other), lambda a, b, axis: a.mean(axis=axis) / b.mean(axis=axis),
                                paired=True, vectorized=True, **options).confidence_interval
        yield {"values": values.tolist(), "other": other.tolist(),
               "mean": [float(mean.low), float(mean.high)], "ratio": [float(ratio.low), float(ratio.high)]}


print(json.dumps({"tests": list(tests()), "intervals": list(intervals())}))
