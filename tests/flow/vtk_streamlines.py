#!/usr/bin/env python3
"""Do streamlines of flow4d.h agree with VTK's vtkStreamTracer, on a measured carotid artery?

    vtk_streamlines.py path/to/flow_streamlines [carotid.vtk]

Both integrate with Runge-Kutta 4 from the same 500 seeds; VTK steps by length, we by time, so places are compared at
equal times of integration. After 50 steps of half a voxel at the greatest speed, the median distance must be at most
0.5 voxel. The file is $LINEAO_DATA/flow/carotid.vtk unless named. Without it or python3-vtk9 it says so and passes.
"""
import math
import os
import random
import struct
import subprocess
import sys

STEPS, SEEDS, BOUND = 50, 500, 0.5


def skip(why):
    print(f"vtk_streamlines: skipped: {why}")
    sys.exit(0)


def read(vtk, path):
    reader = vtk.vtkStructuredPointsReader()
    reader.SetFileName(path)
    reader.ReadAllVectorsOn()
    reader.Update()
    image = reader.GetOutput()
    image.GetPointData().SetActiveVectors(image.GetPointData().GetVectors().GetName())
    return image


def pick_seeds(image, vectors, spacing, origin):
    """Random places, a voxel away from the border, where the flow has at least a tenth of its greatest speed."""
    speeds = [math.sqrt(sum(c * c for c in vectors.GetTuple3(i))) for i in range(vectors.GetNumberOfTuples())]
    size, fastest, seeds, rng = image.GetDimensions(), max(speeds), [], random.Random(1)
    while len(seeds) < SEEDS:
        g = [rng.uniform(1, n - 2) for n in size]
        nearest = [round(x) for x in g]
        if speeds[nearest[0] + size[0] * (nearest[1] + size[1] * nearest[2])] >= 0.1 * fastest:
            seeds.append([o + s * x for o, s, x in zip(origin, spacing, g)])
    return seeds, fastest


def ours(program, size, spacing, origin, vectors, seeds, step):
    floats = [c for i in range(vectors.GetNumberOfTuples()) for c in vectors.GetTuple3(i)]
    raw = struct.pack("<5I", *size, len(seeds), STEPS) + struct.pack("<7d", *spacing, *origin, step)
    raw += struct.pack(f"<{len(floats)}f", *floats) + b"".join(struct.pack("<3d", *s) for s in seeds)
    out = subprocess.run([program], input=raw, stdout=subprocess.PIPE, check=True).stdout
    return [struct.unpack_from("<3d", out, 24 * i) for i in range(len(seeds))]


def theirs(vtk, image, seeds, time, edge):
    """The place of each seed's streamline after `time`, None where it ended before."""
    places = []
    for seed in seeds:
        tracer = vtk.vtkStreamTracer()
        tracer.SetInputData(image)
        tracer.SetStartPosition(*seed)
        tracer.SetIntegratorTypeToRungeKutta4()
        tracer.SetIntegrationDirectionToForward()
        tracer.SetIntegrationStepUnit(1)  # length
        tracer.SetInitialIntegrationStep(0.05 * edge)
        tracer.SetMaximumPropagation(100 * edge)
        tracer.SetMaximumNumberOfSteps(10000)
        tracer.SetComputeVorticity(False)
        tracer.Update()
        line = tracer.GetOutput()
        times, place = line.GetPointData().GetArray("IntegrationTime"), None
        for i in range(1, line.GetNumberOfPoints()):
            a, b = times.GetValue(i - 1), times.GetValue(i)
            if a <= time <= b and b > a:
                u = (time - a) / (b - a)
                place = [p + u * (q - p) for p, q in zip(line.GetPoint(i - 1), line.GetPoint(i))]
                break
        places.append(place)
    return places


def main():
    data = os.environ.get("LINEAO_DATA")
    path = sys.argv[2] if len(sys.argv) > 2 else data and os.path.join(data, "flow", "carotid.vtk")
    if not path or not os.path.exists(path):
        skip("no carotid.vtk; set LINEAO_DATA")
    try:
        import vtk
    except ImportError as error:
        skip(f"python3-vtk9 is not installed ({error})")
    image = read(vtk, path)
    vectors = image.GetPointData().GetVectors()
    spacing, origin = image.GetSpacing(), image.GetOrigin()
    edge = min(spacing)
    seeds, fastest = pick_seeds(image, vectors, spacing, origin)
    step = 0.5 * edge / fastest
    mine = ours(sys.argv[1], image.GetDimensions(), spacing, origin, vectors, seeds, step)
    peer = theirs(vtk, image, seeds, STEPS * step, edge)
    both = [(a, b, s) for a, b, s in zip(mine, peer, seeds) if b and not math.isnan(a[0])]
    away = sorted(math.dist(a, b) / edge for a, b, s in both)
    far = sorted(math.dist(a, s) / edge for a, b, s in both)
    print(f"vtk_streamlines: VTK {vtk.vtkVersion.GetVTKVersion()}, {len(both)} of {len(seeds)} lines reach step {STEPS}; "
          f"way {far[len(far) // 2]:.2f} voxels (median); distance {away[len(away) // 2]:.2g} (median), "
          f"{away[len(away) * 9 // 10]:.2g} (nine of ten), {away[-1]:.2g} (greatest)")
    if len(both) < len(seeds) // 2 or not away[len(away) // 2] <= BOUND:
        print("vtk_streamlines: lines do not agree")
        return 1
    return 0


sys.exit(main())
