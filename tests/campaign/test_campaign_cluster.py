"""The same rows from a Dask cluster as from processes of this machine."""

from __future__ import annotations

import sys

import pytest
from campaigns import cases, hop

from missionkit.campaign import cluster, pool
from missionkit.campaign.row import Order
from missionkit.errors import UsageError

ADDRESS = "tcp://127.0.0.1:1"


def test_without_dask_it_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'missionkit\[cluster\]'"):
        next(cluster.flown(Order("m.yaml", {}), cases(1), address=ADDRESS))


@pytest.mark.filterwarnings("default")
def test_two_dask_workers_give_the_rows_of_the_pool(tmp_path):
    distributed = pytest.importorskip("distributed")
    order = Order(hop(tmp_path), {})
    here = sorted(pool.flown(order, cases(6), workers=2), key=lambda it: it.number)
    local = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(tmp_path)
    )
    with local:
        rows = cluster.flown(order, cases(6), address=local.scheduler_address)
        assert sorted(rows, key=lambda it: it.number) == here
