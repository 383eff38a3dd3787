"""Distances of vertices to the points that are lit at 400 ms by SciPy's cKDTree: near_peer.py FOLDER REACH.

Reads what bench_surface_near --export wrote. Prints one JSON object: seconds of processor time to pick
the lit points, build the tree and ask it (least of 3), and the greatest difference to distances.f32 (mm).
"""
import json
import sys
import time

import numpy
import scipy
from scipy.spatial import cKDTree

folder, reach = sys.argv[1], float(sys.argv[2])
vertices = numpy.fromfile(folder + "/vertices.f32", "<f4").reshape(-1, 3)
points = numpy.fromfile(folder + "/points.f32", "<f4").reshape(-1, 3)
times = numpy.fromfile(folder + "/times.f32", "<f4")
ours = numpy.fromfile(folder + "/distances.f32", "<f4")
least = float("inf")
for _ in range(3):
    start = time.process_time()
    lit = points[numpy.abs(400 - times) < reach]
    distances, _ = cKDTree(lit).query(vertices)
    least = min(least, time.process_time() - start)
print(json.dumps({"program": "SciPy " + scipy.__version__, "lit": len(lit), "seconds": least,
                  "difference": float(numpy.abs(distances - ours).max())}))
