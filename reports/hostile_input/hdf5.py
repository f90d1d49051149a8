"""HDF5 files that lead elsewhere, promise more than they hold, or hold more than they should."""

from __future__ import annotations

import pickle
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import h5py
import numpy as np

from reports.hostile_input.case import SECRET, Case

T: Final = np.arange(50) / 10.0
F: Final = 5.0 + np.sin(T)


class Told:
    """Unpickled, it would leave a file behind; see `hostile_case.Case.never`."""

    def __reduce__(self) -> Any:
        return print, (f"unpickled {SECRET}",)


def hdf5(fill: Callable[[h5py.File], object], *, block: int = 0) -> Callable[[Path], None]:
    """Return what writes a file of a time and what `fill` adds; a file with the secret lies beside it."""

    def make(path: Path) -> None:
        with h5py.File(path.parent / "secret.h5", "w") as secret:
            secret["F"] = np.full(50, SECRET)
        np.full(50, SECRET).tofile(path.parent / "secret.bin")
        with h5py.File(path, "w", userblock_size=block) as file:
            file["t"] = T
            fill(file)

    return make


def external_link(file: h5py.File) -> None:
    file["F"] = h5py.ExternalLink("secret.h5", "/F")


def external_root(file: h5py.File) -> None:
    file["daq"] = h5py.ExternalLink("secret.h5", "/")


def soft_link(target: str) -> Callable[[h5py.File], None]:
    def fill(file: h5py.File) -> None:
        file["F"] = h5py.SoftLink(target)

    return fill


def hard_loop(file: h5py.File) -> None:
    file["F"] = F
    file.create_group("again")
    file["again/again"] = file["again"]
    file["again/root"] = file["/"]


def raw_storage(name: str, size: int = 50) -> Callable[[h5py.File], object]:
    return lambda file: file.create_dataset("F", (size,), "f8", external=[(name, 0, 8 * size)])


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((50,), "f8")
    layout[:] = h5py.VirtualSource("secret.h5", "F", (50,))
    file.create_virtual_dataset("F", layout)


def virtual_on_itself(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((50,), "f8")
    layout[:] = h5py.VirtualSource(".", "F", (50,))
    file.create_virtual_dataset("F", layout)


def absurd(file: h5py.File) -> None:
    file.create_dataset("F", (2**60,), "f8", chunks=(2**20,))


def zeros(values: int, chunk: int, *, times: int) -> Callable[[h5py.File], None]:
    """Return what adds a data set of zeros, deflated several times over, from one small chunk."""

    def fill(file: h5py.File) -> None:
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_chunk((chunk,))
        packed = bytes(8 * chunk)
        for _ in range(times):
            properties.set_deflate(9)
            packed = zlib.compress(packed, 9)
        del file["t"]
        for name in ("t", "F"):
            space = h5py.h5s.create_simple((values,))
            data = h5py.h5d.create(file.id, name.encode(), h5py.h5t.IEEE_F64LE, space, properties)
            for start in range(0, values, chunk):
                data.write_direct_chunk((start,), packed)

    return fill


def many_bombs(file: h5py.File) -> None:
    """Add data sets that are each as large as a small file may unpack to."""
    packed = zlib.compress(bytes(16_000_000), 9)
    for number in range(40):
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_chunk((2_000_000,))
        properties.set_deflate(9)
        space = h5py.h5s.create_simple((2_000_000,))
        data = h5py.h5d.create(file.id, f"F{number}".encode(), h5py.h5t.IEEE_F64LE, space, properties)
        data.write_direct_chunk((0,), packed)
    del file["t"]
    file.create_dataset("t", data=np.arange(2e6, dtype=np.float32), compression="gzip", shuffle=True)


def deep(file: h5py.File) -> None:
    group = file
    for _ in range(10_000):
        group = group.create_group("g")
    group["F"] = F


def many_groups(file: h5py.File) -> None:
    for number in range(120_000):
        h5py.h5g.create(file.id, b"%d" % number)


def references(file: h5py.File) -> None:
    file["F"] = F
    kinds = (h5py.ref_dtype, h5py.regionref_dtype)
    whole = file.create_dataset("to", (50,), kinds[0])
    whole[:] = [file.ref] * 50
    part = file.create_dataset("part", (50,), kinds[1])
    part[:] = [file["F"].regionref[:]] * 50


def exotic(file: h5py.File) -> None:
    file["F"] = F
    numbers = file.create_dataset("ragged", (50,), h5py.vlen_dtype(np.float64))
    numbers[0] = np.arange(10_000.0)
    file.create_dataset("blob", data=np.void(pickle.dumps(Told())))
    nested = np.dtype([("a", [("b", "f8", (3, 3)), ("c", "S8")]), ("d", "O", 1)][:1])
    file.create_dataset("nested", (50,), nested)
    file["committed"] = np.dtype([("x", "f8")])
    file["none"] = h5py.Empty("f8")
    file["complex"] = F.astype(complex)


def pickled(file: h5py.File) -> None:
    file["F"] = F
    file["F"].attrs["units"] = np.void(pickle.dumps(Told()))
    file["F"].attrs["pickle"] = np.frombuffer(pickle.dumps(Told()), np.uint8)


def long_attributes(file: h5py.File) -> None:
    file["F"] = F
    for number in range(5000):
        file["F"].attrs[f"a{number}"] = number
    file.attrs.create("names", np.zeros(6000), dtype="f8")


def names(file: h5py.File) -> None:
    for name in (
        "line\nbreak",
        "\x1b[31mred\x1b[0m",
        "=1+1",
        "...",
        "n" * 5000,
        "\u202egnp.exe",
    ):
        file.create_dataset(name, data=F)


def name_of_bytes(file: h5py.File) -> None:
    file[b"F \xff"] = F


def filtered(file: h5py.File) -> None:
    """Add a data set whose filter would be loaded as a library of the machine."""
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_chunk((50,))
    properties.set_filter(32_015, h5py.h5z.FLAG_OPTIONAL, (3,))
    data = h5py.h5d.create(file.id, b"F", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((50,)), properties)
    data.write_direct_chunk((0,), F.tobytes())


def _case(name: str, attack: str, fill: Callable[[h5py.File], object], said: str, **keys: Any) -> Case:
    return Case("HDF5", name, attack, "log.h5", hdf5(fill), said, never=str(SECRET)[:6], **keys)


ELSEWHERE: Final = "reads another file"
CASES: Final = (
    _case("link into another file", ELSEWHERE, external_link, "is a link into another file"),
    _case("root of another file", ELSEWHERE, external_root, "is a link into another file"),
    _case("soft link to nothing", "a missing object", soft_link("/nowhere"), "is a link to '/nowhere'"),
    _case("soft link to itself", "never ends", soft_link("/F"), "is a link to '/F'"),
    _case("values in another file", ELSEWHERE, raw_storage("secret.bin"), "keeps its values in another file"),
    _case("values in /dev/zero", "reads a device", raw_storage("/dev/zero", 10**7), "in another file"),
    _case("virtual, on another file", ELSEWHERE, virtual, "keeps its values in another file"),
    _case("virtual, on itself", "never ends", virtual_on_itself, "keeps its values in another file"),
    _case("groups in themselves", "never ends", hard_loop, '"name": "F"', refused=False),
    _case("2^60 values declared", "memory", absurd, "declares 1152921504606846976 values"),
    _case("10^10 zeros", "memory", zeros(10**10, 10**7, times=2), "declares 10000000000 values", slow=True),
    _case(
        "9e7 zeros in 3 kB", "memory", zeros(90_000_000, 45_000_000, times=2), "unpacks to more", slow=True
    ),
    _case("40 data sets of zeros", "memory", many_bombs, "2000000, more than a log of its size", slow=True),
    _case("10,000 levels", "the stack", deep, "nested in more than 32 others", slow=True),
    _case("120,000 groups", "time", many_groups, "holds more than 100000 objects", slow=True),
    _case("references", "follows them", references, '"name": "F"', refused=False),
    _case("odd types, a pickle", "unpickles", exotic, '"name": "F"', refused=False),
    _case("pickles as attributes", "unpickles", pickled, '"name": "F"', refused=False),
    _case("long attributes", "memory", long_attributes, '"name": "F"', refused=False),
    _case("odd names", "the terminal", names, r'"name": "line\\nbreak"', refused=False),
    _case("a name of no encoding", "faults", name_of_bytes, "damaged or cut"),
    _case("an unknown filter", "loads a library", filtered, "a filter that is not known"),
)
