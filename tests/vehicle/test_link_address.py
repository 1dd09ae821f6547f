import os
import stat
import subprocess
import sys
import threading

import pytest

from missionkit.errors import UsageError, VehicleError
from missionkit.vehicle.guardian import HOLDER
from missionkit.vehicle.link.link_address import FORMS, parse
from missionkit.vehicle.link.link_lock import LinkLock


@pytest.mark.parametrize("text", FORMS.values())
def test_every_form_is_understood_and_given_to_mavsdk_as_it_is(text):
    assert parse(text).url == text


def test_a_serial_device_has_a_baud_rate_by_default():
    assert parse("serial:///dev/ttyACM0").url == "serial:///dev/ttyACM0:57600"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("14540", "expected an address such as udpin://0.0.0.0:14540"),
        ("udp://:14540", "udp:// is ambiguous, write udpin://0.0.0.0:14540"),
        ("udpinn://0.0.0.0:14540", "did you mean 'udpin'?"),
        ("udpin://0.0.0.0", "host and port are missing, as in udpin://0.0.0.0:14540"),
        ("udpin://:14540", "host and port are missing"),
        ("tcpout://10.0.0.1:99999", "a port is between 1 and 65535"),
        ("tcpout://10.0.0.1:http", "host and port are missing"),
        ("serial://ttyUSB0:57600", "expected a device and a baud rate"),
        ("serial:///dev/ttyUSB0:fast", "expected a device and a baud rate"),
        ("", "expected an address"),
    ],
)
def test_an_invalid_address_is_refused_with_an_example(text, says):
    with pytest.raises(UsageError) as refused:
        parse(text)
    assert says in str(refused.value)


def test_advice_names_port_or_device():
    assert any("14540" in line for line in parse("udpin://0.0.0.0:14540").advice)
    assert any("/dev/ttyUSB0" in line for line in parse("serial:///dev/ttyUSB0:57600").advice)


def test_two_hosts_of_one_bound_port_are_one_link():
    assert parse("udpin://0.0.0.0:14540").key == parse("udpin://127.0.0.1:14540").key
    assert parse("udpout://10.0.0.1:14540").key != parse("udpout://10.0.0.2:14540").key


HOLD = """
import sys
from pathlib import Path
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.guardian import HOLDER
from missionkit.vehicle.link.link_lock import LinkLock
lock = LinkLock(parse("udpin://0.0.0.0:14540"), Path(sys.argv[1]))
lock.take()
print("held", flush=True)
sys.stdin.read()
"""


def test_a_second_process_is_refused_by_name_until_the_first_dies(tmp_path):
    lock = LinkLock(parse("udpin://127.0.0.1:14540"), tmp_path)
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout.readline() == b"held\n"
        with pytest.raises(VehicleError, match=f"process {other.pid}"):
            lock.take()
        other.kill()
    with lock:
        assert lock.path.exists()


def test_another_address_is_free(tmp_path):
    with (
        LinkLock(parse("udpin://0.0.0.0:14540"), tmp_path),
        LinkLock(parse("udpin://0.0.0.0:14541"), tmp_path),
    ):
        pass


def test_a_lock_that_is_a_symbolic_link_is_refused_and_its_target_stays_whole(tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("years of work\n")
    lock = LinkLock(parse("udpin://0.0.0.0:14540"), tmp_path / "locks")
    lock.path.parent.mkdir(mode=0o700)
    lock.path.symlink_to(precious)
    with pytest.raises(VehicleError, match=r"the lock of udpin://0.0.0.0:14540 cannot be used: .+"):
        lock.take()
    assert precious.read_text() == "years of work\n"


def test_a_lock_folder_that_another_user_planted_is_refused(tmp_path):
    real = tmp_path / "real"
    real.mkdir()
    (tmp_path / "locks").symlink_to(real)
    with pytest.raises(VehicleError, match="is not a folder"):
        LinkLock(parse("udpin://0.0.0.0:14540"), tmp_path / "locks").take()
    assert not list(real.iterdir())


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_a_lock_folder_of_another_user_is_refused(tmp_path):
    (tmp_path / "locks").mkdir(mode=0o777)
    os.chown(tmp_path / "locks", 12345, 12345)
    with pytest.raises(VehicleError, match="belongs to another user"):
        LinkLock(parse("udpin://0.0.0.0:14540"), tmp_path / "locks").take()


def test_the_lock_folder_is_the_users_own(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    with LinkLock(parse("udpin://0.0.0.0:14540")) as lock:
        assert lock.path.parent == tmp_path / f"missionkit-{os.getuid()}"
        assert stat.S_IMODE(lock.path.parent.stat().st_mode) == 0o700
        assert lock.path.read_text() == f"{os.getpid()}\n"


def test_the_lock_waits_for_a_guardian_whose_mission_has_ended(tmp_path):
    address = parse("udpin://0.0.0.0:14540")
    with LinkLock(address, tmp_path) as held:
        held.path.write_text(f"{HOLDER} 1234\n")
        waiting = LinkLock(address, tmp_path)
        thread = threading.Thread(target=waiting.take)
        thread.start()
        thread.join(0.1)
        assert thread.is_alive()
    thread.join(10.0)
    assert not thread.is_alive()
    assert waiting.path.read_text() == f"{os.getpid()}\n"
    waiting.release()
