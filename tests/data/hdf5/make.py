"""Files as h5py writes them, for tests/base/hdf5.cpp: python make.py by_h5py.h5 group_in_itself.h5 (h5py 3)."""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "w") as f:
    f["plain"] = np.arange(6.0).reshape(2, 3)
    f["big_endian"] = np.arange(4, dtype=">f8")
    f.create_dataset("packed", data=np.arange(1000.0), chunks=(100,), compression="gzip", shuffle=True)
    f["short"] = np.arange(3, dtype="i2")
    f["flag"] = np.array([True, False])
    f["complex"] = np.array([1 + 2j])
    f["fixed"] = np.array([b"abc", b"de"])
    f["words"] = ["a", "", "\u00b0"]
    f["word"] = "one"
    f["nothing"] = h5py.Empty("f8")
    f["empty"] = np.zeros((0, 3))
    f["group/inner"] = np.array([7], dtype="i4")
    f["alias"] = f["plain"]
    f["soft"] = h5py.SoftLink("/plain")
    f["dangling"] = h5py.SoftLink("/nowhere")
    f["elsewhere"] = h5py.ExternalLink("other.h5", "/secret")
    f["through"] = h5py.SoftLink("/elsewhere")
    f.create_dataset("outside", (4,), "f8", external=[("passwd", 0, 32)])
    f.create_dataset("huge", (1 << 40, 1 << 20), "f8", chunks=(1024, 1024))
    f["plain"].attrs["unit"] = "m/s"
    f["plain"].attrs["range"] = [-1.0, 1.0]
    f["plain"].attrs["count"] = np.int64(5)
    f["plain"].attrs["small"] = np.int16(5)
    f["plain"].attrs["fixed"] = np.bytes_("abc")
    f["plain"].attrs["matrix"] = np.eye(2)
    f.attrs["names"] = ["x", "y"]
    f["group"].attrs["time"] = 0.25
with h5py.File(sys.argv[2], "w") as f:
    group = f.create_group("a")
    group["a"] = group  # within itself
