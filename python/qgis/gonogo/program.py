"""Runs the program gonogo: progress and remarks go to the feedback, a refusal becomes the algorithm's error.

Plug-ins run in the Python of QGIS, which need not be one that the package gonogo was built for. The program always fits.
"""
import json
import os
import re
import shutil
import signal
import subprocess
import threading
import time

from qgis.core import QgsProcessingException

SETTING = "GONOGO_PROGRAM"
_DONE_OF_TOTAL = re.compile(r": (\d+)/(\d+) ")


def program_path():
    """From the environment, the settings of Processing, or PATH."""
    from processing.core.ProcessingConfig import ProcessingConfig

    path = os.environ.get(SETTING) or ProcessingConfig.getSetting(SETTING) or shutil.which("gonogo")
    if not path or not os.access(path, os.X_OK):
        raise QgsProcessingException(f"program gonogo: not found at {path or 'any place of PATH'}; install it, or name it in "
                                     "Settings, Options, Processing, Providers, gonogo")
    return path


def run_program(arguments, feedback):
    """Returns the result of `gonogo --json <arguments>`. Raises QgsProcessingException with the program's sentence."""
    command = [program_path(), "--json", *arguments]
    feedback.pushCommandInfo(" ".join(command))
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        lines = []
        reader = threading.Thread(target=lambda: lines.extend(process.stdout), daemon=True)
        reader.start()
        threading.Thread(target=_stop_when_cancelled, args=(process, feedback), daemon=True).start()
        for line in process.stderr:
            report(line.rstrip(), feedback)
        reader.join()
    if feedback.isCanceled():
        raise QgsProcessingException("cancelled")
    return result_of(lines, process.returncode)


def _stop_when_cancelled(process, feedback):
    """An interrupt lets the program end its files well."""
    while process.poll() is None:
        if feedback.isCanceled():
            process.send_signal(signal.SIGINT)
            return
        time.sleep(0.2)


def report(line, feedback):
    """One line of stderr: progress or a remark."""
    found = _DONE_OF_TOTAL.search(line)
    if found and int(found[2]) > 0:
        feedback.setProgress(100 * int(found[1]) / int(found[2]))
    if line:
        feedback.pushInfo(line)


def result_of(lines, status):
    """The last line of stdout is one JSON object: the result, or the error."""
    try:
        result = json.loads(lines[-1])
    except (IndexError, ValueError):
        raise QgsProcessingException(f"gonogo ended with status {status} and no answer") from None
    if status != 0:
        error = result.get("error", {})
        raise QgsProcessingException(error.get("message", str(error)) if isinstance(error, dict) else str(error))
    return result
