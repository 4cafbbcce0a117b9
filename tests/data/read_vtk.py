"""Reads a .vtp or .vti file with VTK and prints what it holds as JSON, every number as its bits."""

import json
import struct
import sys

import vtk


def bits(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def numbers(array):
    components = array.GetNumberOfComponents()
    return [
        bits(array.GetComponent(row, component))
        for row in range(array.GetNumberOfTuples())
        for component in range(components)
    ]


def fields(data):
    return {
        data.GetArray(index).GetName(): {
            "type": data.GetArray(index).GetDataTypeAsString(),
            "components": data.GetArray(index).GetNumberOfComponents(),
            "values": numbers(data.GetArray(index)),
        }
        for index in range(data.GetNumberOfArrays())
    }


def read(reader):
    complaints = []
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda source, event: complaints.append(event))
    reader.SetFileName(sys.argv[1])
    reader.Update()
    data = reader.GetOutput()
    found = {
        "complaints": complaints,
        "point_data": fields(data.GetPointData()),
        "field_data": fields(data.GetFieldData()),
    }
    return data, found


def surface():
    surface, found = read(vtk.vtkXMLPolyDataReader())
    found["triangles"] = []
    for index in range(surface.GetNumberOfPolys()):
        ids = surface.GetCell(index).GetPointIds()
        corners = [ids.GetId(corner) for corner in range(ids.GetNumberOfIds())]
        found["triangles"].append(corners)
    found["other_cells"] = surface.GetNumberOfCells() - surface.GetNumberOfPolys()
    found["positions"] = numbers(surface.GetPoints().GetData())
    return found


def grid():
    grid, found = read(vtk.vtkXMLImageDataReader())
    found["counts"] = grid.GetDimensions()
    found["origin"] = [bits(number) for number in grid.GetOrigin()]
    found["spacings"] = [bits(number) for number in grid.GetSpacing()]
    points = range(grid.GetNumberOfPoints())
    found["points"] = [grid.GetPoint(index) for index in points]
    return found


json.dump(grid() if sys.argv[1].endswith(".vti") else surface(), sys.stdout)
