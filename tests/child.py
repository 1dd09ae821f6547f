"""Programs that tests start as processes of their own."""

import signal


def default_signals():
    """Heed signals, however the tests were started: `nohup` and `&` have children ignore some.

    A `preexec_fn` of `subprocess.Popen`.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
