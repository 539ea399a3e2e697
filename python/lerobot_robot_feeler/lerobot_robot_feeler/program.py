"""The program ``feeler follow`` as a child process: a request and an answer per line."""

from __future__ import annotations

import contextlib
import json
import queue
import subprocess
import threading
from collections.abc import Sequence
from typing import Any

PROTOCOL = 1
"""Supported version of the protocol."""

ANSWER_TIMEOUT = 5.0
"""Time without an answer after which the program is considered hanging, s."""

EXIT_TIMEOUT = 60.0
"""Time for closing the recording and writing its report, s."""


class ProgramError(RuntimeError):
    """The program ended, hangs, or rejected a request."""


class Program:
    """A running ``feeler follow``. Its messages for people go to standard error."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = list(command)
        try:
            self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        except OSError as error:
            raise ProgramError(f"{self.command[0]}: {error}; install feeler, or set `program` to its path") from error
        self.lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._read, name="feeler follow", daemon=True).start()
        try:
            self.hand = self._answer()
            if (protocol := self.hand.get("protocol")) != PROTOCOL:
                raise ProgramError(f"expected feeler's protocol {PROTOCOL}, got {protocol}; update the older one")
        except BaseException:
            self.process.kill()
            self.process.wait()
            raise

    @property
    def is_running(self) -> bool:
        return self.process.poll() is None

    def ask(self, request: dict[str, Any]) -> dict[str, Any]:
        """Sends a request and returns the answer."""
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(json.dumps(request, allow_nan=False) + "\n")
            self.process.stdin.flush()
        except OSError as error:
            raise ProgramError(self._ended()) from error
        answer = self._answer()
        if "error" in answer:
            raise ProgramError(f"feeler follow: {answer['error']}")
        return answer

    def close(self) -> None:
        """Ends the program, which stops the hand and closes the recording."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        try:
            self.process.wait(EXIT_TIMEOUT)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.put(line)
        self.lines.put(None)

    def _answer(self) -> dict[str, Any]:
        try:
            line = self.lines.get(timeout=ANSWER_TIMEOUT)
        except queue.Empty:
            raise ProgramError(f"feeler follow has not answered for {ANSWER_TIMEOUT} s") from None
        if line is None:
            raise ProgramError(self._ended())
        answer = json.loads(line)
        if not isinstance(answer, dict):
            raise ProgramError(f"expected a JSON object from feeler follow, got {line!r}")
        return answer

    def _ended(self) -> str:
        try:
            status = self.process.wait(1.0)
        except subprocess.TimeoutExpired:
            status = None
        return f"{' '.join(self.command)} ended with status {status}; its messages are on standard error"
