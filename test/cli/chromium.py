"""A headless Chromium, controlled over its debugging pipe with only the standard library. Ends a test
with 77 (skipped) without it."""
import json
import os
import shutil
import subprocess
import time

from support import skip

PROGRAM = next((path for name in ("chromium", "chromium-browser", "google-chrome")
                if (path := shutil.which(name))), None)
if PROGRAM is None:
    skip("chromium is missing")


class Chromium:
    """Opens one page. Messages end with a zero byte: commands go to its descriptor 3, answers and
    events come from 4."""

    def __init__(self, profile, width=1280, height=900):
        to_browser, self.out = os.pipe()
        self.inp, from_browser = os.pipe()

        def descriptors():
            # Above descriptors 3 and 4, so that neither replaces the other.
            first, second = os.dup2(to_browser, 20), os.dup2(from_browser, 21)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self.process = subprocess.Popen(
            [PROGRAM, "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
             f"--user-data-dir={profile}", f"--window-size={width},{height}", "about:blank"],
            preexec_fn=descriptors, close_fds=False, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.last, self.session, self.questions = b"", 0, None, 0
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"],
                                 flatten=True)["sessionId"]
        self.call("Page.enable")

    def message(self):
        while b"\0" not in self.buffer:
            part = os.read(self.inp, 1 << 16)
            if not part:
                raise RuntimeError("Chromium has ended")
            self.buffer += part
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def send(self, method, params):
        self.last += 1
        command = {"id": self.last, "method": method, "params": params}
        if self.session and not method.startswith(("Target.", "Browser.")):
            command["sessionId"] = self.session
        os.write(self.out, json.dumps(command).encode() + b"\0")
        return self.last

    def call(self, method, **params):
        """Leaves a page that asks whether to leave it; `questions` counts them."""
        sent = self.send(method, params)
        while True:
            answer = self.message()
            if answer.get("method") == "Page.javascriptDialogOpening":
                self.questions += 1
                self.send("Page.handleJavaScriptDialog", {"accept": True})
            if answer.get("id") == sent:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]

    def evaluate(self, script):
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True,
                           awaitPromise=True)
        assert "exceptionDetails" not in answer, (script, answer["exceptionDetails"])
        return answer["result"].get("value")

    def open(self, path):
        answer = self.call("Page.navigate", url="file://" + os.path.abspath(path))
        assert "errorText" not in answer, (path, answer["errorText"])
        self.wait(lambda: self.evaluate("document.readyState === 'complete' && "
                                        "document.URL !== 'about:blank'"))

    @staticmethod
    def wait(condition, seconds=120):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "waited in vain"
            time.sleep(0.05)

    def press(self, key):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key,
                      text=key if kind == "keyDown" and len(key) == 1 else "")

    def click(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left",
                      buttons=1, clickCount=1)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        try:
            self.call("Browser.close")
        except (RuntimeError, OSError):
            pass
        try:
            self.process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self.process.kill()
        os.close(self.out)
        os.close(self.inp)
