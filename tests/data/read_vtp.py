"""Reads a .vtp file with VTK and prints what it holds as JSON, every number as its bits."""

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


complaints = []
reader = vtk.vtkXMLPolyDataReader()
for event in ("ErrorEvent", "WarningEvent"):
    reader.AddObserver(event, lambda source, event: complaints.append(event))
reader.SetFileName(sys.argv[1])
reader.Update()
surface = reader.GetOutput()
triangles = []
for index in range(surface.GetNumberOfPolys()):
    corners = surface.GetCell(index).GetPointIds()
    triangles.append([corners.GetId(corner) for corner in range(corners.GetNumberOfIds())])
json.dump(
    {
        "complaints": complaints,
        "other_cells": surface.GetNumberOfCells() - surface.GetNumberOfPolys(),
        "positions": numbers(surface.GetPoints().GetData()),
        "triangles": triangles,
        "point_data": fields(surface.GetPointData()),
        "field_data": fields(surface.GetFieldData()),
    },
    sys.stdout,
)
