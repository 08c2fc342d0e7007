"""Tests that a run releases the interpreter, and that Ctrl-C stops it."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import basrelief
from basrelief import Machine


def test_other_threads_go_on_while_a_machine_runs() -> None:
    scene, machine = basrelief.demo("golf-ball", size=(320, 240)), Machine("bump")
    took = []

    def run() -> None:
        began = time.perf_counter()
        machine.run(scene, exact=False, bottlenecks=False, engine="ticked")
        took.append(time.perf_counter() - began)

    thread = threading.Thread(target=run)
    # Measures from before the start of the thread, because `start` waits for the thread and may itself be delayed.
    longest, last = 0.0, time.perf_counter()
    thread.start()
    while True:
        now = time.perf_counter()
        longest, last = max(longest, now - last), now
        if not thread.is_alive():
            break
        time.sleep(0.001)
    # If the run held the lock, this loop would wait for almost the whole run.
    assert longest < 0.5 * took[0], f"{longest:.3f} s of {took[0]:.3f} s"


def test_runs_of_one_scene_at_once_are_those_one_after_the_other() -> None:
    scene = basrelief.demo("golf-ball", size=(64, 48))
    machines = [Machine("bump", **{"replacement.entries": entries}) for entries in (16, 32, 64, 128)]
    alone = [machine.run(scene).report for machine in machines]
    with ThreadPoolExecutor(4) as pool:
        assert [result.report for result in pool.map(lambda machine: machine.run(scene), machines)] == alone


def test_ctrl_c_stops_a_run() -> None:
    script = """
import basrelief, sys
scene = basrelief.demo("sphere", size=(640, 480), frames=1000, orbit=360)
try:
    print("running", flush=True)
    basrelief.Machine("bump").run(scene, exact=False, bottlenecks=False)
except KeyboardInterrupt:
    print("stopped", basrelief.Machine("shade").name, flush=True)
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "running\n"
        time.sleep(0.3)
        began = time.perf_counter()
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
        assert (out, process.returncode) == ("stopped shade\n", 0)
        assert time.perf_counter() - began < 10
    finally:
        process.kill()


def test_a_machine_and_a_scene_go_to_processes() -> None:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    scene, machine = basrelief.demo("golf-ball", size=(32, 24)), Machine("bump")
    for method in ("spawn", "fork"):
        with ProcessPoolExecutor(1, mp_context=get_context(method)) as pool:
            result = pool.submit(machine.run, scene).result(timeout=60)
        assert pickle.dumps(result.report) == pickle.dumps(machine.run(scene).report)
