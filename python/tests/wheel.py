#!/usr/bin/env python3
"""What a wheel without GDAL and LibTorch does, in one breath: a shipped model, a problem, a bed. Fails with a traceback."""
import gonogo

model = gonogo.Model("hmmwv")
level, steep = model.predict({"slope_along": [0, 30]})
assert level > 0.9 > 0.2 > steep, (level, steep)
assert model.to_bqm({"slope_along": 15}, "SPIN").num_variables > 20
bed = gonogo.Bed.settle(0.5, 0.5, 0.25, grain_diameter=0.1, threads=1)
assert 0.2 < bed.highest_point < 0.4, bed.highest_point
try:
    gonogo.map("elevation.tif", model, out="map")
except gonogo.InputError as error:
    assert "GDAL" in str(error) or "no_such" in str(error), error
print("gonogo", gonogo.__version__, "works")
