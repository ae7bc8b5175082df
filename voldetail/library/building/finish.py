"""All chunks of a build made one library: the Zarr group and what queries need of each entry."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from voldetail.errors import InputError
from voldetail.files import flush
from voldetail.library.building.plan import Plan
from voldetail.library.building.staging import Staging
from voldetail.library.layout import FORMAT, FORMAT_VERSION, arrays_of, step_of
from voldetail.library.measures import MEASURES
from voldetail.library.tables import worked_out
from voldetail.library.vectors import digest, weights, weights_definition


def finish(staging: Staging, path: Path, on_entries: Callable[[int], None]) -> None:
    """Write the library at ``path``, where nothing may be, from a staging folder that has all chunks.

    The same plan gives the same bytes. on_entries is told how many entries are written. Raises InputError where a chunk is
    damaged or the disk is full.
    """
    import zarr  # not on top: it takes half a second to load, and reading a library needs none of it

    plan = staging.plan
    shutil.rmtree(path, ignore_errors=True)  # what a stopped build left
    try:
        with zarr.config.set({"async.concurrency": 1, "threading.max_workers": 1}):
            root = zarr.create_group(str(path), attributes=_attributes(plan))
            done = 0
            for place, (source, count) in enumerate(zip(plan.sources, plan.counts, strict=True)):
                group = root.create_group(source.name)
                layouts = arrays_of(count, len(source.keys), plan.measure)
                arrays = {name: _created(group, layout) for name, layout in layouts.items()}
                reader, content, step = staging.rows(place), hashlib.sha256(), step_of(count)
                for first in range(0, count, step):
                    here = slice(first, min(first + step, count))
                    values, vectors = reader.next(here.stop - first)
                    arrays["values"][here], arrays["vectors"][here] = values, vectors
                    if MEASURES[plan.measure].outlined:
                        norms, outlines = worked_out(np.ascontiguousarray(vectors, np.float32), weights(plan.w_global))
                        arrays["norms"][here], arrays["outlines"][:, here] = norms, outlines
                    content.update(values.tobytes() + vectors.tobytes())
                    done += here.stop - first
                    on_entries(done)
                said = {"keys": list(source.keys), "seed": source.seed, "entries": count, "definition": dict(source.definition)}
                group.update_attributes(said | {"sha256": content.hexdigest()})
        _flush_all(path)
    except OSError as error:
        raise InputError(
            f"Cannot write the library in {path.parent}: {error.strerror or error}; the entries are kept: free some space and "
            "give the same command again."
        ) from error


def _attributes(plan: Plan) -> dict[str, Any]:
    definition = MEASURES[plan.measure].definition()
    return {
        "format": FORMAT, "version": FORMAT_VERSION, "measure": plan.measure, "descriptor": definition,
        "descriptor_sha256": digest(definition),
        "weights": weights_definition(plan.w_global), "sources": [source.name for source in plan.sources],
    }  # fmt: skip


def _created(group: Any, array: Any) -> Any:
    from zarr.codecs import BytesCodec

    return group.create_array(
        array.name, shape=array.shape, chunks=array.chunk, dtype=array.kind, compressors=None, filters=None,
        serializer=BytesCodec(endian="little"), fill_value=0.0,
        config={"write_empty_chunks": True},  # or a chunk of zeros would have no file
    )  # fmt: skip


def _flush_all(path: Path) -> None:
    """Bring files to the disk before the library gets its name, so that a crash leaves all of it or none."""
    for folder, _, files in os.walk(path):
        for name in files:
            flush(Path(folder) / name)
        with suppress(OSError):  # some file systems cannot flush a folder
            flush(Path(folder))
