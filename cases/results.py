"""Results of a run as numpy arrays, and what the cases' scripts ask of them.

Array shapes: parcels (n,), (n, 3); gas fields (z, y, x) or (z, y, x, 3). SI units.
"""

from pathlib import Path

import h5py
import numpy as np


class Parcels:
    """parcels.vtkhdf: all parcels at the times of `times` [s]."""

    def __init__(self, path):
        self.file = h5py.File(path, "r")
        self.root = self.file["VTKHDF"]
        self.steps = self.root["Steps"]
        self.count = int(self.steps.attrs["NSteps"])
        self.times = self.steps["Values"][: self.count]

    def __call__(self, step):
        """Everything known of the parcels at a step (negative: from the last), by name."""
        step %= self.count
        first = int(self.steps["PointOffsets"][step])
        points = slice(first, first + int(self.root["NumberOfPoints"][step]))
        data = {"position": self.root["Points"][points].astype(float)}
        for name, values in self.root["PointData"].items():
            kept = values[points]
            data[name] = kept.astype(float) if kept.dtype.kind == "f" else kept
        return data


class Gas:
    """gas.vtkhdf: cell fields at the times of `times` [s]."""

    def __init__(self, path):
        self.file = h5py.File(path, "r")
        self.root = self.file["VTKHDF"]
        self.count = int(self.root["Steps"].attrs["NSteps"])
        self.times = self.root["Steps/Values"][: self.count]
        extent = np.asarray(self.root.attrs["WholeExtent"]).reshape(3, 2)
        self.cells = extent[:, 1] - extent[:, 0]
        self.h = np.asarray(self.root.attrs["Spacing"], float)
        self.lower = np.asarray(self.root.attrs["Origin"], float)
        self.upper = self.lower + self.cells * self.h

    def __call__(self, name, step):
        return self.root["CellData"][name][step % self.count].astype(float)

    def centres(self, axis):
        """Coordinates of the cell centres along x, y or z (0, 1, 2) [m]."""
        return self.lower[axis] + (np.arange(self.cells[axis]) + 0.5) * self.h[axis]


class Run:
    """The results in a folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.parcels = Parcels(self.folder / "parcels.vtkhdf")
        self.gas = Gas(self.folder / "gas.vtkhdf")
        self.monitor = h5py.File(self.folder / "monitor.h5", "r")
        self.series = {name: values[()] for name, values in self.monitor["series"].items()}


def vtk_steps(path):
    """Time steps that VTK itself can read from a file, and the points or cells in the last: (steps, items)."""
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    readable = sum(bool(reader.UpdateTimeStep(time)) for time in times)
    data = reader.GetOutputDataObject(0)
    if data.IsA("vtkPartitionedDataSet"):
        data = data.GetPartition(0)
    return readable, data.GetNumberOfPoints() if data.IsA("vtkPolyData") else data.GetNumberOfCells()


def mean_with_error(values, blocks=8):
    """Time mean of an evenly sampled series and its standard error, from the scatter of block means.

    Means of blocks are independent only if the blocks are longer than the memory of the series: so the
    error is the largest that any number of blocks gives, from four long ones to `blocks` short ones.
    """
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    if len(values) < 2 * blocks:
        return float(np.mean(values)) if len(values) else np.nan, np.nan
    errors = []
    for number in range(4, blocks + 1):
        means = [part.mean() for part in np.array_split(values, number)]
        errors.append(np.std(means, ddof=1) / np.sqrt(number))
    return float(values.mean()), float(max(errors))


def log_normal_by_number(mean, deviation, smallest, largest, points=4001):
    """Sizes [m] and, of a clipped log-normal by number, the fraction of the number and of the mass that is finer."""
    variance = np.log(1 + (deviation / mean) ** 2)
    sizes = np.linspace(smallest, largest, points)
    density = np.exp(-((np.log(sizes / mean) + variance / 2) ** 2) / (2 * variance)) / sizes
    finer = [np.concatenate([[0], np.cumsum((f[1:] + f[:-1]) / 2)]) for f in (density, density * sizes**3)]
    return sizes, finer[0] / finer[0][-1], finer[1] / finer[1][-1]


def means(diameter, weight):
    """Number mean, Sauter mean and mass mean diameter of real particles, `weight` of each size."""
    powers = [np.sum(weight * diameter**k) for k in range(5)]
    return powers[1] / powers[0], powers[3] / powers[2], powers[4] / powers[3]


def regions(mask):
    """Label the connected regions of a two-dimensional mask (edge neighbours), 0 outside: labels, how many."""
    labels = np.zeros(mask.shape, int)
    found = 0
    for start in zip(*np.nonzero(mask)):
        if labels[start]:
            continue
        found += 1
        labels[start] = found
        front = [start]
        while front:
            i, j = front.pop()
            for a, b in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
                if 0 <= a < mask.shape[0] and 0 <= b < mask.shape[1] and mask[a, b] and not labels[a, b]:
                    labels[a, b] = found
                    front.append((a, b))
    return labels, found
