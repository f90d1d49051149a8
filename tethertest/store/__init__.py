"""The run store: a conditioned run in one HDF5 file, written whole or not at all, read with suspicion."""

from tethertest.store.layout import StoredRun, StoreHeader
from tethertest.store.read import OpenStore, StoredSeries, is_store, load_store, open_store
from tethertest.store.whole import written_whole
from tethertest.store.write import new_store, write_store

__all__ = [
    "OpenStore",
    "StoreHeader",
    "StoredRun",
    "StoredSeries",
    "is_store",
    "load_store",
    "new_store",
    "open_store",
    "write_store",
    "written_whole",
]
