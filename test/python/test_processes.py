"""Threads at the end of the interpreter, and processes of every start method."""

import concurrent.futures
import multiprocessing
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import vpr

WINDOWS = {"c_l": 5, "score": "zscore", "decide": "margin"}
END = """
import sys, threading, time, warnings, numpy as np, vpr
warnings.simplefilter("ignore")
rows = np.load("monday.npy")
db = vpr.train(descriptors=rows)
distances = vpr.distances(db, rows)
windows = {"c_l": 5, "score": "zscore", "decide": "margin"}
result = vpr.query(db, descriptors=rows, **windows)
report = vpr.evaluate(result)
works = [lambda: vpr.query(db, descriptors=rows, **windows), lambda: np.asarray(distances),
         lambda: vpr.train(descriptors=rows, progress=lambda *step: time.sleep(0.001)),
         lambda: result.best, report.frames, lambda: db.descriptors]
def call_for_ever(work):
    while True:
        try: work()
        except Exception: pass
for i in range(int(sys.argv[1])):
    threading.Thread(target=call_for_ever, args=(works[i % len(works)],), daemon=True).start()
time.sleep(float(sys.argv[2]))
"""


@pytest.mark.parametrize("threads", [1, 3, 8])
def test_threads_that_always_call_end_with_the_interpreter(walks, threads):
    for number in range(4):
        done = subprocess.run([sys.executable, "-c", END, str(threads), str(0.02 * number)],
                              cwd=walks, capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stderr) == (0, "")


def test_calls_after_the_end_has_begun_are_answered_in_the_main_thread(walks):
    code = ("import atexit\n"
            "def late(): print(len(vpr.query(db, descriptors='tuesday.npy').best))\n"
            "atexit.register(late)\n"
            "import numpy as np, vpr\n"
            "rows = np.load('monday.npy'); db = vpr.train(descriptors=rows)\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=walks, capture_output=True, text=True,
                          timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "200\n", "")


def test_a_subinterpreter_is_refused():
    code = ("import _xxsubinterpreters as interpreters, sys\n"
            "code = 'import warnings; warnings.simplefilter(\"ignore\"); import vpr'\n"
            "try: interpreters.run_string(interpreters.create(), code)\n"
            "except interpreters.RunFailedError as error: print(error, flush=True)\n")
    if sys.version_info >= (3, 13):
        pytest.skip("Python 3.13 has another module of interpreters")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert "vpr does not run in a sub-interpreter. Use a process" in done.stdout, done.stderr


def recognize(walks):
    db = vpr.load(os.path.join(walks, "db.vprdb"))
    return vpr.query(db, descriptors=os.path.join(walks, "tuesday.npy"), **WINDOWS).best.tolist()


@pytest.fixture(scope="module")
def expected(walks):
    vpr.train(descriptors=walks / "monday.npy").save(walks / "db.vprdb")
    return recognize(walks)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_processes_find_the_same_matches(walks, expected, method, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(
        [os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")]))
    context = multiprocessing.get_context(method)
    with context.Pool(2) as pool:
        assert pool.map_async(recognize, [str(walks)] * 4).get(timeout=120) == [expected] * 4
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as executor:
        assert list(executor.map(recognize, [str(walks)] * 4, timeout=120)) == [expected] * 4


@pytest.mark.parametrize("backend", ["loky", "multiprocessing", "threading"])
def test_joblib_finds_the_same_matches(walks, expected, backend):
    joblib = pytest.importorskip("joblib")
    found = joblib.Parallel(2, backend=backend, timeout=120)(
        joblib.delayed(recognize)(str(walks)) for _ in range(4))
    assert found == [expected] * 4


def fork_and_call(call):
    """The text that the call returns or raises in a forked process."""
    receiver, sender = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        try:
            text = call()
        except BaseException as error:
            text = f"{type(error).__name__}: {error}"
        os.write(sender, text.encode())
        os._exit(0)
    os.close(sender)
    with os.fdopen(receiver) as pipe:
        text = pipe.read()
    assert os.waitpid(child, 0)[1] == 0
    return text


def test_a_process_forked_during_a_call_ends(walks):
    code = ("import os, threading, numpy as np, vpr\n"
            "rows = np.load('monday.npy'); started = threading.Event(); may_end = threading.Event()\n"
            "def wait(*step): started.set(); may_end.wait(60)\n"
            "call = dict(descriptors=np.tile(rows, (20, 1)), progress=wait)\n"
            "threading.Thread(target=vpr.train, kwargs=call).start(); started.wait(60)\n"
            "child = os.fork()\n"
            "if child == 0: vpr.train(descriptors=rows)\n"
            "else: print(os.waitpid(child, 0)[1], flush=True); may_end.set()\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=walks, capture_output=True, text=True,
                          timeout=60)
    assert (done.returncode, done.stdout) == (0, "256\n") and "method spawn" in done.stderr


def test_a_process_forked_during_a_call_names_the_cause(walks):
    rows = np.load(walks / "monday.npy")
    db = vpr.train(descriptors=rows)
    in_call, may_end = threading.Event(), threading.Event()

    def wait(step, done, total):
        in_call.set()
        may_end.wait(60)

    def call():
        return f"{len(vpr.query(db, descriptors=walks / 'tuesday.npy').best)} matches"
    thread = threading.Thread(target=lambda: vpr.train(descriptors=np.tile(rows, (20, 1)), progress=wait))
    thread.start()
    assert in_call.wait(60)
    text = fork_and_call(call)
    may_end.set()
    thread.join()
    assert text.startswith("UsageError: this process was forked while another thread was in a call")
    assert "method spawn" in text
    assert fork_and_call(call) == call() == "200 matches"
