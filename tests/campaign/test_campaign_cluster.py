"""The same rows from a Dask cluster as from processes of this machine; one that breaks is a row."""

from __future__ import annotations

import sys
from concurrent.futures import CancelledError

import pytest
from campaigns import bombed, cases, hop

from missionkit.campaigns import dask_cluster, process_pool
from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.errors import UsageError, VehicleError

ADDRESS = "tcp://127.0.0.1:1"
PATIENCE = 60.0  # s for a run that is not to hang


def test_without_dask_the_error_names_the_missing_package(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"pip install 'missionkit\[cluster\]'"):
        next(dask_cluster.flown(RunOrder("m.yaml", {}), cases(1), address=ADDRESS))


def test_an_address_without_a_scheduler_is_reported(monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECTING", 0.3)
    with pytest.raises(VehicleError, match=f"no Dask cluster answers at {ADDRESS}"):
        next(dask_cluster.flown(RunOrder("m.yaml", {}), cases(1), address=ADDRESS))


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Two workers on the loopback; none of their processes is left behind."""
    import dask  # noqa: PLC0415 - heavy
    import distributed  # noqa: PLC0415
    import psutil  # noqa: PLC0415

    settings = {"distributed.scheduler.allowed-failures": 0}
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            local_directory=str(tmp_path_factory.mktemp("dask")),
        ) as local,
    ):
        yield local.scheduler_address
        processes = [nanny.pid for nanny in local.workers.values()]
    assert len(processes) == 2
    assert not any(map(psutil.pid_exists, processes))


@pytest.mark.filterwarnings("default")
def test_two_dask_workers_give_the_rows_of_the_pool(address, tmp_path):
    order = RunOrder(hop(tmp_path), {})
    here = sorted(process_pool.flown(order, cases(6), workers=2), key=lambda it: it.number)
    rows = dask_cluster.flown(order, cases(6), address=address, timeout=PATIENCE)
    assert sorted(rows, key=lambda it: it.number) == here
    assert [it.outcome for it in here] == ["success"] * 6


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize(
    ("how", "timeout", "outcome", "reason"),
    [
        ("die", PATIENCE, "lost", "the cluster gave up on it: every worker that flew it died"),
        ("hang", 2.0, "hung", "no result within 2 s"),
    ],
)
def test_a_worker_that_breaks_is_a_row_and_replaced(
    address, tmp_path, how, timeout, outcome, reason
):
    mission, plugin = bombed(tmp_path)
    order = RunOrder(mission, {}, (plugin,))
    bad = Case(9, 0, 0, {"how": how})
    (row,) = dask_cluster.flown(order, [bad], address=address, timeout=timeout)
    assert (row.number, row.outcome) == (9, outcome)
    assert row.reason == reason
    assert row.visits == ()
    rows = dask_cluster.flown(order, cases(3), address=address, timeout=PATIENCE)
    assert [it.outcome for it in rows] == ["success"] * 3


class Vanishing:
    """A client whose scheduler goes away after some questions."""

    def __init__(self, error, answers):
        self.error, self.answers = error, answers

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def nthreads(self):
        self.answers -= 1
        if self.answers < 0:
            raise self.error
        return {"worker": 1}

    def submit(self, *_, **__):
        return Future()


class Future:
    key = "run"

    def done(self):
        return True

    def exception(self):
        raise CancelledError


@pytest.mark.parametrize("answers", [0, 1])
@pytest.mark.parametrize(
    "error", [ConnectionResetError("reset by peer"), TimeoutError(), CancelledError()]
)
def test_a_lost_scheduler_is_reported_in_a_sentence(monkeypatch, error, answers):
    monkeypatch.setattr(dask_cluster, "_client", lambda *_: Vanishing(error, answers))
    monkeypatch.setattr(dask_cluster, "_ended", lambda _, flying: list(flying))
    with pytest.raises(VehicleError, match=f"lost the Dask cluster at {ADDRESS}") as caught:
        list(dask_cluster.flown(RunOrder("m.yaml", {}), cases(3), address=ADDRESS))
    assert "repeat the command to fly the rest" in str(caught.value)
    assert caught.value.exit_code == 3
