"""The result files as their readers see them: VTK, h5py and an XML parser on what unit programs wrote."""

import xml.etree.ElementTree as xml

import h5py
import numpy as np
import pytest
import vtk
from conftest import launch, program
from vtk.util.numpy_support import vtk_to_numpy

CELLS = (6, 10, 4)


def run(name, folder, ranks):
    done = launch(program(f"tests/unit/{name}"), folder, ranks=ranks, time_limit=120)
    assert done.returncode == 0 and "FAIL" not in done.stdout and "finished" in done.stdout, done.stdout + done.stderr


@pytest.fixture(scope="module", params=[1, 2, 4])
def files(request, tmp_path_factory):
    """A folder with parcels.vtkhdf and gas.vtkhdf of 5 steps, written by some number of ranks."""
    folder = tmp_path_factory.mktemp("vtkhdf")
    run("test_vtkhdf", folder, request.param)
    return folder


def steps_of(file):
    """All times of a VTKHDF file and a function that gives the data of a time."""
    reader = vtk.vtkHDFReader()
    assert reader.CanReadFile(str(file))
    reader.SetFileName(str(file))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())

    def data_at(time):
        reader.UpdateTimeStep(time)
        data = reader.GetOutputDataObject(0)
        return data.GetPartition(0) if data.IsA("vtkPartitionedDataSet") else data

    return times, data_at


def field(data, name):
    return vtk_to_numpy(data.GetArray(name))


def test_vtk_reads_every_step_of_the_parcels(files):
    times, data_at = steps_of(files / "parcels.vtkhdf")
    assert np.allclose(times, [0, 0.1, 0.2, 0.3, 0.4])
    for step, time in reversed(list(enumerate(times))):
        cloud = data_at(time)
        n = 10000 + 1000 * step
        ids = np.arange(1, n + 1)
        positions = np.stack([np.sin(ids), np.cos(ids), np.full(n, 0.1 * step)], axis=1)
        assert cloud.GetNumberOfPoints() == n
        assert cloud.GetNumberOfCells() == 1 and cloud.GetCell(0).GetNumberOfPoints() == n
        assert np.array_equal(field(cloud.GetPointData(), "id"), ids)
        assert np.array_equal(field(cloud.GetPointData(), "powder"), ids % 3)
        assert np.allclose(vtk_to_numpy(cloud.GetPoints().GetData()), positions, atol=1e-7)
        assert np.allclose(field(cloud.GetPointData(), "velocity"), 2 * positions, atol=1e-7)
        assert np.allclose(field(cloud.GetPointData(), "diameter"), 1e-3 / ids, rtol=1e-7)


def expected_gas(step):
    i, j, k = np.meshgrid(*(np.arange(1, n + 1) for n in CELLS), indexing="ij")
    void_fraction = 1 / (i + 10 * j + 100 * k + 1000 * step)
    velocity = np.stack([i, j, k + step], axis=-1)
    # VTK counts x fastest, which is C order of [k, j, i].
    return void_fraction.transpose(2, 1, 0), velocity.transpose(2, 1, 0, 3)


def test_vtk_reads_every_step_of_the_gas(files):
    times, data_at = steps_of(files / "gas.vtkhdf")
    assert np.allclose(times, [0, 0.1, 0.2, 0.3, 0.4])
    for step, time in reversed(list(enumerate(times))):
        grid = data_at(time)
        void_fraction, velocity = expected_gas(step)
        assert grid.GetDimensions() == tuple(n + 1 for n in CELLS)
        assert np.allclose(grid.GetOrigin(), [0.1, 0.2, 0.3]) and np.allclose(grid.GetSpacing(), [0.01, 0.02, 0.03])
        assert np.allclose(field(grid.GetCellData(), "void_fraction"), void_fraction.ravel(), rtol=1e-7)
        assert np.array_equal(field(grid.GetCellData(), "velocity"), velocity.reshape(-1, 3))


def test_vtk_reads_every_step_of_a_graded_grid(files):
    times, data_at = steps_of(files / "graded.vtkhdf")
    assert np.allclose(times, [0, 0.1, 0.2, 0.3, 0.4])
    for step, time in reversed(list(enumerate(times))):
        grid = data_at(time)
        void_fraction, velocity = expected_gas(step)
        assert grid.IsA("vtkRectilinearGrid") and grid.GetDimensions() == tuple(n + 1 for n in CELLS)
        assert np.allclose(vtk_to_numpy(grid.GetXCoordinates()), 0.1 + 0.01 * np.arange(CELLS[0] + 1))
        assert np.allclose(vtk_to_numpy(grid.GetYCoordinates()), 0.2 + 0.02 * np.arange(CELLS[1] + 1) ** 2)
        assert np.allclose(vtk_to_numpy(grid.GetZCoordinates()), 0.3 + 0.03 * np.arange(CELLS[2] + 1))
        assert np.allclose(field(grid.GetCellData(), "void_fraction"), void_fraction.ravel(), rtol=1e-7)
        assert np.array_equal(field(grid.GetCellData(), "velocity"), velocity.reshape(-1, 3))


def test_files_tell_where_they_come_from(files):
    for name in ("parcels", "gas"):
        with h5py.File(files / f"{name}.vtkhdf") as file:
            origin = file["geldart"].attrs
            assert origin["title"] == b"a test" and origin["version"] == b"0.1" and origin["commit"] == b"abc"
            assert origin["case"] == b"&run title = 'a test' /\n"
    with h5py.File(files / "parcels.vtkhdf") as file:
        assert file["VTKHDF/PointData/velocity"].attrs["unit"] == b"m/s"
        assert file["VTKHDF/Points"].shape == (60000, 3)
    with h5py.File(files / "gas.vtkhdf") as file:
        assert file["VTKHDF/CellData/void_fraction"].attrs["unit"] == b"1"


def pieces(files, name):
    """Every hyperslab a sidecar names, read from the .vtkhdf file: [(time, field, array)]."""
    found = []
    for grid in xml.parse(files / f"{name}.xmf").getroot().iter("Grid"):
        if grid.get("GridType") != "Uniform":
            continue
        time = float(grid.find("Time").get("Value"))
        places = [("position", item) for item in grid.findall("Geometry/DataItem[@ItemType]")]
        places += [(a.get("Name"), a.find("DataItem")) for a in grid.findall("Attribute")]
        for label, item in places:
            slab, source = item.findall("DataItem")
            start, stride, count = np.array(slab.text.split(), int).reshape(3, -1)
            file, path = source.text.strip().split(":")
            with h5py.File(files / file) as h5:
                assert h5[path].shape == tuple(map(int, source.get("Dimensions").split()))
                assert str(h5[path].dtype.itemsize) == source.get("Precision")
                array = h5[path][tuple(slice(a, a + n) for a, n in zip(start, count))]
            array = array.reshape(tuple(map(int, item.get("Dimensions").split())))
            found.append((time, label, array))
    return found


def test_sidecars_describe_the_same_data(files):
    clouds = pieces(files, "parcels")
    grids = pieces(files, "gas")
    assert len(clouds) == 5 * 5 and len(grids) == 5 * 2
    graded = xml.parse(files / "graded.xmf").getroot().find(".//Grid[@GridType='Uniform']")
    assert graded.find("Topology").get("TopologyType") == "3DRectMesh"
    y = np.array(graded.findall("Geometry/DataItem")[1].text.split(), float)
    assert np.allclose(y, 0.2 + 0.02 * np.arange(CELLS[1] + 1) ** 2)
    for time, label, array in clouds:
        step = round(10 * time)
        ids = np.arange(1, 10001 + 1000 * step)
        if label == "id":
            assert np.array_equal(array, ids)
        if label == "position":
            assert np.allclose(array[:, 0], np.sin(ids), atol=1e-7) and np.allclose(array[:, 2], time)
    for time, label, array in grids:
        void_fraction, velocity = expected_gas(round(10 * time))
        assert np.allclose(array, velocity if label == "velocity" else void_fraction, rtol=1e-7)


@pytest.mark.parametrize("ranks", [1, 2])
def test_series_in_h5py(tmp_path, ranks):
    run("test_series", tmp_path, ranks)
    with h5py.File(tmp_path / "monitor.h5") as file:
        series, other = file["series"], file["monitors/other"]
        rows = np.arange(1101)
        assert np.allclose(series["time"], 0.001 * rows) and np.array_equal(series["height"], rows)
        assert np.array_equal(series["velocity"], rows[:, None] * [10, 20, 30])
        assert series["profile"].shape == (1101, 4, 3)
        assert np.allclose(series["profile"][7].ravel(), 7 + 0.01 * np.arange(1, 13))
        assert series["velocity"].attrs["unit"] == b"m/s" and series["height"].attrs["meaning"] == b"of the bed"
        assert np.array_equal(other["count"], np.arange(0, 1101, 10))
        # A column that a continued run adds has no values before.
        half = other["half"][:]
        assert np.all(np.isnan(half[:101])) and np.array_equal(half[101:], np.arange(505, 551, 5))
        assert other.attrs["kind"] == b"box" and np.array_equal(other["position"], [[1, 2, 3], [4, 5, 6]])
        assert file["geldart"].attrs["case"] == b"&run /"


def test_restart_is_read_on_other_numbers_of_ranks(tmp_path):
    run("test_restart", tmp_path, 4)
    for ranks in (1, 2, 3):
        done = launch(program("tests/unit/test_restart"), tmp_path, "read", ranks=ranks, time_limit=120)
        assert done.returncode == 0 and "FAIL" not in done.stdout and "finished" in done.stdout, done.stdout + done.stderr
    with h5py.File(tmp_path / "restart.h5") as file:
        column = np.arange(1, 1002)
        assert np.array_equal(file["state"], np.array([1, 2, 5]) / (7.0 * column[:, None]))
        assert file["geldart"].attrs["ranks"] == 4
