"""The Dask client that a run uses: the user's, one of a scheduler, or a cluster of this machine."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def connected(client: Any, workers: int | None) -> Iterator[Any]:
    """A client: `client` itself, one of the scheduler at that address, or of a local cluster of
    `workers` processes. ImportError where there is no Dask, OSError where no scheduler answers.
    """
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise ImportError("Dask is needed: pip install 'mavwire[fleet]'") from error
    if client is not None and not isinstance(client, str):
        yield client
    elif client is not None:
        with Client(client, set_as_default=False) as made:
            yield made
    else:
        processors = os.cpu_count() or 1
        count = workers or processors
        # Each process decodes on as many threads as are its share of the processors.
        share = {"RAYON_NUM_THREADS": str(max(1, processors // count))}
        with (
            LocalCluster(
                n_workers=count, threads_per_worker=1, dashboard_address="127.0.0.1:0", env=share
            ) as cluster,
            Client(cluster, set_as_default=False) as made,
        ):
            yield made
