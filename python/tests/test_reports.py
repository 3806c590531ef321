"""Inputs like those of reports in public trackers, with the right answers. tests/data/cases/README.md lists all of them; those of
rasters and shapes are in tests/terrain/reports.cpp."""
import json
import subprocess

import dimod
import netCDF4
import numpy as np
import pytest
import rasterio

import gonogo
from gonogo import samplers
from gonogo.sklearn import RbmClassifier


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def box_world(gravity=(0, 0, -9.81), friction=0.5):
    world = gonogo.World((6, 4, 4), gravity=gravity)
    world.add_floor(0.0, material=1)
    world.set_law(0, 1, friction=friction)
    world.set_law(0, 0, friction=friction)
    return world


def test_mujoco_3328_what_friction_holds_does_not_creep():
    """A box on a slope at 0.95 of what friction holds, for 2 s: regularised friction creeps at 50 to 2,300 micrometres per second."""
    slope = np.arctan(0.95 * 0.5)
    world = box_world(gravity=(9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)))
    box = world.add_box((2, 2, 0.1), (0.1, 0.1, 0.1), density=1000)
    simulation = gonogo.Simulation([world], step=1e-3, iterations=200, tolerance=1e-7)
    simulation.step(500)
    start = simulation.bodies().position[box].copy()
    simulation.step(2000)
    assert np.abs(simulation.bodies().position[box] - start).max() < 2e-6


def test_dart_3442_a_heavy_box_does_not_sink_through_a_light_one():
    world = box_world()
    light = world.add_box((2, 2, 0.1), (0.1, 0.1, 0.1), density=1000)
    heavy = world.add_box((2, 2, 0.3), (0.1, 0.1, 0.1), density=100_000)
    simulation = gonogo.Simulation([world], step=1e-3, iterations=400, tolerance=1e-6)
    simulation.step(1000)
    heights = simulation.bodies().position[:, 2]
    assert heights[heavy] == pytest.approx(0.3, abs=1e-3)
    assert heights[light] == pytest.approx(0.1, abs=1e-3)
    assert simulation.unsolved == ""


def test_avian_593_boxes_without_restitution_do_not_bounce_off_each_other():
    world = box_world()
    world.add_box((2, 2, 0.1), (0.1, 0.1, 0.1), density=1000)
    falling = world.add_box((2, 2, 0.8), (0.1, 0.1, 0.1), density=10_000)
    simulation = gonogo.Simulation([world], step=1e-3, iterations=400, tolerance=1e-6)
    heights = []
    for _ in range(80):
        simulation.step(10)
        heights.append(simulation.bodies().position[falling, 2])
    landed = int(np.argmax(np.array(heights) < 0.301))
    assert 0 < landed < 40  # 0.5 m fall in 0.32 s
    assert np.max(heights[landed:]) < 0.302


def test_genesis_3115_a_cube_at_20_m_per_s_neither_lifts_nor_turns():
    world = gonogo.World((60, 2, 2))
    world.add_floor(0.0, material=1)
    world.set_law(0, 1, friction=0.5)
    cube = world.add_box((1, 1, 0.05), (0.05, 0.05, 0.05), density=1000)
    world.set_velocity(cube, (20, 0, 0))
    simulation = gonogo.Simulation([world], step=1e-3, iterations=200, tolerance=1e-6)
    simulation.step(4500)
    bodies = simulation.bodies()
    assert bodies.position[cube] == pytest.approx([1 + 20**2 / 9.81, 1, 0.05], abs=0.1)
    assert np.abs(bodies.orientation[cube]).max() == pytest.approx(1, abs=1e-5)


def test_mujoco_warp_814_a_stack_of_boxes_stays():
    world = box_world()
    boxes = [world.add_box((2, 2, 0.1 + 0.2 * k), (0.1, 0.1, 0.1), density=1000) for k in range(6)]
    simulation = gonogo.Simulation([world], step=1e-3, iterations=400, tolerance=1e-6)
    simulation.step(1500)
    place = simulation.bodies().position[boxes]
    assert place[:, :2] == pytest.approx(np.full((6, 2), 2.0), abs=1e-3)
    assert place[:, 2] == pytest.approx(0.1 + 0.2 * np.arange(6), abs=1e-3)


def converted(program, folder, problem, name):
    """A problem in dimod's JSON, written in another format and back."""
    (folder / "a.json").write_text(json.dumps(problem))
    run(program, "qubo", "convert", folder / "a.json", "--out", folder / name)
    run(program, "qubo", "convert", folder / name, "--out", folder / "b.json")
    return json.loads((folder / "b.json").read_text())


def test_dimod_767_the_offset_survives_a_coo_file(program, tmp_path):
    bqm = dimod.BinaryQuadraticModel.from_ising({}, {(a, b): 1.0 for a in range(4) for b in range(a)}, offset=42)
    back = dimod.BinaryQuadraticModel.from_serializable(converted(program, tmp_path, bqm.to_serializable(), "a.coo"))
    assert back.offset == 42
    assert back == bqm


def test_dimod_223_a_pair_keeps_its_energy_whichever_way_it_is_written(program, tmp_path):
    bqm = dimod.BinaryQuadraticModel({"b": 1.0, "a": -2.0}, {("b", "a"): -1.5}, 0.25, "SPIN")
    back = dimod.BinaryQuadraticModel.from_serializable(converted(program, tmp_path, bqm.to_serializable(), "a.bqpjson"))
    for row in dimod.ExactSolver().sample(bqm).data(["sample", "energy"]):
        assert back.energy(row.sample) == row.energy


@pytest.mark.parametrize("sampler", [samplers.BlockGibbs, samplers.Annealer, samplers.Exact])
def test_dimod_458_dwave_system_454_labels_come_back_as_they_were_given(sampler):
    """Tuples, texts and numbers, in an order of their own, each with its own value."""
    labels = [(0, "high"), "z", 7, (1, (2, "a")), "a"]
    field = {label: 5.0 if k % 2 else -5.0 for k, label in enumerate(labels)}
    rows = sampler().sample(dimod.BinaryQuadraticModel.from_ising(field, {}), num_reads=20, seed=1)
    assert list(rows.variables) == labels
    assert rows.first.sample == {label: -1 if h > 0 else 1 for label, h in field.items()}
    again = dimod.SampleSet.from_serializable(json.loads(json.dumps(rows.to_serializable())))
    assert set(again.variables) == set(labels)


def test_pyqubo_176_variables_keep_their_order(program, tmp_path):
    """dimod sorts labels where it writes them; other programs do not."""
    names = [f"x[0][{k}]" for k in (6, 11, 10, 7, 4, 3, 2, 5, 8, 9, 1, 0)]
    problem = dimod.BinaryQuadraticModel({name: 0.5 for name in names}, {}, 0.0, "BINARY").to_serializable()
    problem.update(variable_labels=names, linear_biases=[0.5 + k for k in range(len(names))])
    back = converted(program, tmp_path, problem, "a.coo")
    assert back["variable_labels"] == names
    assert back["linear_biases"] == problem["linear_biases"]


def test_scikit_learn_9694_sparse_features_do_not_all_look_alike():
    """A machine over features that are 1 in a twentieth of the rows tells the rows apart."""
    rng = np.random.default_rng(2)
    given = (rng.random((1500, 12)) < 0.05).astype(float)
    wanted = (given[:, 0] + given[:, 1] > 0).astype(int)
    fitted = RbmClassifier(epochs=100, random_state=1).fit(given, wanted)
    p = fitted.predict_proba(given)[:, 1]
    assert p[wanted == 1].min() > p[wanted == 0].max()


def netcdf_of(path, heights, **attributes):
    """Packed heights as CF has them, in UTM zone 10."""
    with netCDF4.Dataset(path, "w") as file:
        rows, columns = heights.shape
        for name, count, first, step in (("x", columns, 500005, 10), ("y", rows, 4399995, -10)):
            file.createDimension(name, count)
            axis = file.createVariable(name, "f8", (name,))
            axis.standard_name, axis.units = f"projection_{name}_coordinate", "m"
            axis[:] = first + step * np.arange(count)
        system = file.createVariable("crs", "i4")
        system.setncatts({"grid_mapping_name": "transverse_mercator", "latitude_of_projection_origin": 0.0,
                          "longitude_of_central_meridian": -123.0, "scale_factor_at_central_meridian": 0.9996, "false_easting": 500000.0,
                          "false_northing": 0.0, "semi_major_axis": 6378137.0, "inverse_flattening": 298.257223563,
                          "crs_wkt": rasterio.crs.CRS.from_epsg(32610).to_wkt()})
        z = file.createVariable("z", "i2", ("y", "x"), fill_value=attributes.pop("fill", -32767))
        z.set_auto_maskandscale(False)
        z.setncatts({"grid_mapping": "crs", **attributes})
        z[:] = heights


def test_terra_314_a_valid_range_is_one_of_packed_values(program, tmp_path):
    """2 x 20 heights of 0 to 0.95 m in steps of 0.05: a range of 0 to 0.5 m is one of 0 to 50 counts, not of 0 to 0."""
    counts = np.tile(np.arange(0, 100, 5, dtype="i2"), (20, 1))
    netcdf_of(tmp_path / "a.nc", counts, scale_factor=0.01, valid_range=np.array([0, 50], "i2"))
    run(program, "map", "--model", "hmmwv", "--dem", tmp_path / "a.nc", "--soil", "sand", "--moisture", "dry", "--out", tmp_path / "map")
    known = ~np.isnan(gonogo.read_raster(tmp_path / "map/p_go.tif").values)
    assert known[1:-1, 1:10].all()  # slopes need the neighbours' heights
    assert not known[:, 10:].any()


