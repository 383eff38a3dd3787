#!/usr/bin/python3
"""VTK's way to draw the same lines: tubes with 6 sides and vtkSSAOPass with 59 samples.

    vtk_peer.py LINES [--size WxH] [--frames N] [--warm-up N] [--png FILE]

LINES is what `lineao_bench --export-lines` wrote; radius and camera come from there. Prints one JSON
object with the median and the least time of a frame, ms; the camera turns by one degree a frame.
Without a DISPLAY, an X server of its own is started (Xvfb). Needs Debian's python3-vtk9, nothing else.
"""
import argparse
import array
import json
import os
import resource
import shutil
import statistics
import struct
import subprocess
import sys
import time


def fail(text):
    sys.exit(f"lineao: vtk_peer: {text}")


def read_lines(path):
    with open(path, "rb") as file:
        data = file.read()
    head = struct.Struct("=8sIIf10d")
    if len(data) < head.size or data[:8] != b"LAOBENCH":
        fail(f"{path} was not written by lineao_bench --export-lines")
    fields = head.unpack_from(data)
    lines, points = fields[1:3]
    cut = head.size + 4 * (lines + 1)
    if len(data) != cut + 12 * points:
        fail(f"{path} is cut short")
    scene = {"lines": lines, "points": points, "width": fields[3], "eye": fields[4:7],
             "center": fields[7:10], "up": fields[10:13], "fovy": fields[13]}
    scene["offsets"] = array.array("i", data[head.size:cut])
    scene["xyz"] = array.array("f", data[cut:])
    return scene


def start_display():
    """Xvfb on a free number, which it writes to a pipe; the caller ends it."""
    if os.environ.get("DISPLAY"):
        return None
    if not shutil.which("Xvfb"):
        fail("there is no DISPLAY and no Xvfb (Debian package xvfb)")
    come, go = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(go), "-screen", "0", "1920x1920x24", "+extension", "GLX", "-nolisten", "tcp"],
        pass_fds=[go], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(go)
    with os.fdopen(come) as pipe:
        number = pipe.readline().strip()
    if not number:
        fail("Xvfb did not start")
    os.environ["DISPLAY"] = ":" + number
    return server


def make_poly_data(vtk, scene):
    coordinates = vtk.vtkFloatArray()
    coordinates.SetNumberOfComponents(3)
    coordinates.SetVoidArray(scene["xyz"], 3 * scene["points"], 1)
    points = vtk.vtkPoints()
    points.SetData(coordinates)
    scene["ids"] = array.array("i", range(scene["points"]))
    offsets, ids = vtk.vtkTypeInt32Array(), vtk.vtkTypeInt32Array()
    offsets.SetVoidArray(scene["offsets"], scene["lines"] + 1, 1)
    ids.SetVoidArray(scene["ids"], scene["points"], 1)
    cells = vtk.vtkCellArray()
    cells.SetData(offsets, ids)
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetLines(cells)
    return data


def make_window(vtk, scene, width, height):
    tubes = vtk.vtkTubeFilter()
    tubes.SetInputData(make_poly_data(vtk, scene))
    tubes.SetRadius(0.5 * scene["width"])
    tubes.SetNumberOfSides(6)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(tubes.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(scene["eye"])
    camera.SetFocalPoint(scene["center"])
    camera.SetViewUp(scene["up"])
    camera.SetViewAngle(scene["fovy"])
    tubes.Update()
    renderer.ResetCameraClippingRange()
    size = tubes.GetOutput().GetLength()
    ssao = vtk.vtkSSAOPass()
    ssao.SetRadius(0.05 * size)
    ssao.SetBias(0.0005 * size)
    ssao.SetKernelSize(59)
    ssao.BlurOff()
    ssao.SetDelegatePass(vtk.vtkRenderStepsPass())
    renderer.SetPass(ssao)
    window = vtk.vtkRenderWindow()
    window.SetMultiSamples(0)
    window.SetOffScreenRendering(1)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    return window, camera


def draw(window):
    start = time.perf_counter()
    window.Render()
    window.WaitForCompletion()
    return 1e3 * (time.perf_counter() - start)


def write_png(vtk, window, path):
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(grab.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


def measure(options):
    import vtk  # after DISPLAY is there
    width, height = (int(word) for word in options.size.split("x"))
    scene = read_lines(options.lines)
    window, camera = make_window(vtk, scene, width, height)
    first = draw(window)
    times = []
    for frame in range(1, options.warm_up + options.frames):
        camera.Azimuth(1)
        spent = draw(window)
        if frame >= options.warm_up:
            times.append(spent)
    if options.png:
        write_png(vtk, window, options.png)
    return {"program": "VTK " + vtk.vtkVersion().GetVTKVersion(), "lines": scene["lines"],
            "points": scene["points"], "width": width, "height": height, "frames": len(times),
            "first_frame_ms": round(first, 3), "median_ms": round(statistics.median(times), 3),
            "min_ms": round(min(times), 3),
            "peak_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("lines")
    parser.add_argument("--size", default="1706x1834")
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--warm-up", type=int, default=1)
    parser.add_argument("--png")
    options = parser.parse_args()
    server = start_display()
    try:
        print(json.dumps(measure(options)))
    finally:
        if server:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
