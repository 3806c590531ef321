"""How long calls live with Python: Ctrl-C, other threads."""
import os
import signal
import threading
import time

import pytest

import gonogo


def endless():
    world = gonogo.World((4, 4, 4))
    world.add_sphere((2, 2, 2), radius=0.1)
    world.add_floor(1.9)
    return gonogo.Simulation([world])


def test_ctrl_c_stops_a_long_call_and_the_next_one_runs():
    simulation = endless()
    handler = signal.getsignal(signal.SIGINT)
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        simulation.step(2_000_000_000)
    assert time.monotonic() - start < 5
    assert signal.getsignal(signal.SIGINT) is handler
    before = simulation.report().time
    simulation.step(10)
    assert simulation.report().time > before
    with pytest.raises(KeyboardInterrupt):  # Python's own handler is back
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)


def test_other_threads_run_meanwhile():
    simulation, counted, over = endless(), 0, threading.Event()

    def count():
        nonlocal counted
        while not over.is_set():
            counted += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        simulation.step(2_000_000_000)
    over.set()
    counter.join()
    assert counted > 50
