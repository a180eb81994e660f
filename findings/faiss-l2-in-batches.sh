#!/usr/bin/env bash
# faiss' IndexFlatL2 finds the nearest descriptor for 19 queries, and another one for 20 of the same.
#   Package: python3-faiss 1.7.3-2+b1 (Debian 12).
#   Guess: the exact index gives each query the same neighbor, however many are searched at once.
#   Seen: descriptors of length 1 whose neighbors are 0.00014 apart, as of a camera that stands
#   still. Of 19 queries that are in the index, each finds itself; of the first 20, about 6. From 20 on,
#   squared distances are sums and differences of norms and products, which cancel in 32 bits.
#
# Makes a minimal Debian 12 with these packages in a temporary folder. Needs root and the package mmdebstrap.
# Exits with 0 if this is still so.
set -euo pipefail
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mmdebstrap --variant=apt --include=python3-faiss,python3-numpy bookworm "$root" >"$root.log" 2>&1 || { cat "$root.log"; exit 2; }
rm "$root.log"
[[ $(chroot "$root" dpkg-query -W -f='${Version}' python3-faiss) == 1.7.3-2+b1 ]]
echo "python3-faiss 1.7.3-2+b1"
chroot "$root" python3 - <<'PYTHON'
import sys

import faiss
import numpy as np

kStill, kPlaces, kSize = 5, 200, 512
random = np.random.default_rng(0)
places = random.random((kPlaces, kSize))
places /= np.linalg.norm(places, axis=1, keepdims=True)
noise = random.standard_normal((kStill * kPlaces, kSize))
frames = np.repeat(places, kStill, axis=0) + 1e-4 / np.sqrt(kSize) * noise
frames = (frames / np.linalg.norm(frames, axis=1, keepdims=True)).astype("f4")
distances = np.linalg.norm((frames[:20, None].astype("f8") - frames[None, :20]), axis=2)
np.fill_diagonal(distances, 1)
print(f"nearest other frame: at least {distances.min():.6f} away")

index = faiss.IndexFlatL2(kSize)
index.add(frames)
found = {}
for count in (1, 19, 20):
    best = index.search(frames[:count], 1)[1][:, 0]
    found[count] = int((best == np.arange(count)).sum())
    print(f"{count} queries at once: {found[count]} find themselves")
sys.exit(0 if found[1] == 1 and found[19] == 19 and found[20] < 15 and distances.min() > 5e-5 else 1)
PYTHON
