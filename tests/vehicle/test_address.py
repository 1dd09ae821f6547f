import subprocess
import sys

import pytest

from missionkit.errors import UsageError, VehicleError
from missionkit.vehicle.address import FORMS, parse
from missionkit.vehicle.lock import LinkLock


@pytest.mark.parametrize("text", FORMS.values())
def test_every_form_is_understood_and_given_to_mavsdk_as_it_is(text):
    assert parse(text).url == text


def test_a_serial_device_has_a_baud_rate_by_default():
    assert parse("serial:///dev/ttyACM0").url == "serial:///dev/ttyACM0:57600"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("14540", "expected an address such as udpin://0.0.0.0:14540"),
        ("udp://:14540", "udp:// is not precise, write udpin://0.0.0.0:14540"),
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
def test_what_is_no_address_is_refused_with_an_example(text, says):
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
from missionkit.vehicle.address import parse
from missionkit.vehicle.lock import LinkLock
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
