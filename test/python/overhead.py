#!/usr/bin/env python3
"""overhead.py PROGRAMS [ROUNDS [FRAMES]]: the time of vpr.query on arrays as a ratio to the time of vpr-query without
reading its query, on one thread. Runs both in turn and prints medians of pairs. Needs vpr in PYTHONPATH."""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import vpr

QUERIES = {"filter": {}, "windows of distances": {"c_l": 20, "t_r": 0.4},
           "windows of z-scores": {"c_l": 20, "score": "zscore", "decide": "margin"}}

programs = pathlib.Path(sys.argv[1]).resolve()
rounds, frames = int(sys.argv[2]) if len(sys.argv) > 2 else 10, int(sys.argv[3]) if len(sys.argv) > 3 else 10000
random = np.random.default_rng(1)
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    for kind in ("vectors", "codes"):
        train, query = (random.standard_normal((n, 512), np.float32) if kind == "vectors"
                        else random.integers(0, 256, (n, 176), np.uint8) for n in (frames, frames // 10))
        np.save(folder / f"{kind}.npy", query)
        db = vpr.train(descriptors=train)
        db.save(folder / f"{kind}.vprdb")
        for title, settings in QUERIES.items():
            flags = [word for key, value in settings.items() for word in ("--" + key.replace("_", "-"), str(value))]
            ratios, seconds = [], []
            for _ in range(rounds):
                subprocess.run([programs / "vpr-query", folder / f"{kind}.vprdb", "--query",
                                folder / f"{kind}.npy", *flags, "--threads", "1", "--force", "--quiet", "-o",
                                folder / "r.json"], check=True)
                timing = json.loads((folder / "r.json").read_text())["timing"]
                started = time.perf_counter()
                vpr.query(db, descriptors=query, threads=1, **settings)
                seconds.append(time.perf_counter() - started)
                ratios.append(seconds[-1] / max(0.001, timing["total_s"] - timing["describe_s"]))
            print(f"{kind}, {title}: {statistics.median(seconds):.3f} s, {statistics.median(ratios):.3f} "
                  "of the program")
