"""The pictures of lineao_bench --screen --export-fills, filled by OpenCV's inpainting: fill_peer.py FOLDER.

Prints one JSON object: per size and method seconds (one thread, least of 3) and the root mean square
error over what was empty, in the units of the picture (mm of depth, about 30 to 170).
"""
import glob
import json
import os
import re
import sys
import time

import cv2
import numpy

cv2.setNumThreads(1)
methods = {"Navier-Stokes": cv2.INPAINT_NS, "Telea": cv2.INPAINT_TELEA}
rows = []
for path in glob.glob(os.path.join(sys.argv[1], "fill_*.f32")):
    size = int(re.search(r"(\d+)\.f32", path).group(1))
    picture, covered, truth = numpy.fromfile(path, "<f4").reshape(3, size, size)
    empty = (covered == 0).astype(numpy.uint8)
    for name, method in methods.items():
        least = float("inf")
        for _ in range(3):
            start = time.process_time()
            filled = cv2.inpaint(picture, empty, 3, method)
            least = min(least, time.process_time() - start)
        error = numpy.sqrt(numpy.mean((filled - truth)[empty == 1].astype("f8") ** 2))
        rows.append({"size": size, "method": name, "seconds": least, "error": float(error)})
rows.sort(key=lambda row: (row["size"], row["method"]))
print(json.dumps({"program": "OpenCV " + cv2.__version__, "rows": rows}))
