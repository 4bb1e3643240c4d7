#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws solved blocks side by side, coloured by how far points sank. Needs VTK's Python module and a display (xvfb-run).

usage: picture.py OUT.png JOB...     JOB.inp and JOB.frd as compress.py leaves them
"""

import pathlib
import sys

import vtk

CELLS = {4: vtk.VTK_TETRA, 8: vtk.VTK_HEXAHEDRON, 10: vtk.VTK_QUADRATIC_TETRA}


def block(job):
    points, grid, index = vtk.vtkPoints(), vtk.vtkUnstructuredGrid(), {}
    into = None
    for line in job.with_suffix(".inp").read_text().splitlines():
        if line.startswith("*"):
            into = line.split(",")[0]
        elif into == "*NODE":
            number, *xyz = line.split(",")
            index[int(number)] = points.InsertNextPoint(*map(float, xyz))
        elif into == "*ELEMENT":
            corners = [index[int(n)] for n in line.split(",")[1:]]
            grid.InsertNextCell(CELLS[len(corners)], len(corners), corners)
    sunk = vtk.vtkDoubleArray()
    sunk.SetName("sunk")
    sunk.SetNumberOfTuples(len(index))
    reading = False
    for line in job.with_suffix(".frd").read_text().splitlines():  # columns of fixed width
        if line.startswith(" -4"):
            reading = line.split()[1] == "DISP"
        elif line.startswith(" -3"):
            reading = False
        elif reading and line.startswith(" -1"):
            sunk.SetValue(index[int(line[3:13])], -float(line[37:49]))
    grid.SetPoints(points)
    grid.GetPointData().SetScalars(sunk)
    return grid


def main():
    out, *jobs = map(pathlib.Path, sys.argv[1:])
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(700 * len(jobs), 700)
    colours = vtk.vtkLookupTable()
    colours.SetHueRange(0.62, 0.02)
    colours.Build()
    for i, job in enumerate(jobs):
        surface = vtk.vtkDataSetSurfaceFilter()
        surface.SetInputData(block(job))
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputConnection(surface.GetOutputPort())
        mapper.SetLookupTable(colours)
        mapper.SetScalarRange(0, 0.1)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetEdgeVisibility(True)
        actor.GetProperty().SetEdgeColor(0.15, 0.15, 0.15)
        actor.GetProperty().SetLineWidth(0.5)
        view = vtk.vtkRenderer()
        view.SetViewport(i / len(jobs), 0, (i + 1) / len(jobs), 1)
        view.SetBackground(1, 1, 1)
        view.AddActor(actor)
        camera = view.GetActiveCamera()
        camera.SetPosition(-1.5, -2.2, 1.3)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetViewUp(0, 0, 1)
        window.AddRenderer(view)
        view.ResetCamera()
        camera.Zoom(1.1)
    window.Render()
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(picture.GetOutputPort())
    writer.SetFileName(str(out))
    writer.Write()


if __name__ == "__main__":
    main()
