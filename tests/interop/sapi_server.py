"""A solver interface (SAPI, resource representation version 3) on this machine's loopback address.

It serves one solver to D-Wave's cloud client: GET solvers/remote/, POST problems/, GET problems/?id=..., GET problems/<id>/.
What is posted is handed to `solve(body) -> answer`, run beside the requests, so that the client has to poll; DELETE and
uploads are not served. Media types are those that the client insists on (docs.dwavequantum.com, "SAPI REST").
"""
import json
import re
import threading
import zlib
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit

MEDIA = "application/vnd.dwave.sapi.%s+json; version=3.0.0"


class SapiServer(ThreadingHTTPServer):
    """Use as a context manager; `endpoint` and `token` are the client's settings, `posted` what it sent."""

    daemon_threads = True

    def __init__(self, solver, solve, token="loopback"):
        super().__init__(("127.0.0.1", 0), Handler)
        self.solver, self.solve, self.token = solver, solve, token
        self.problems, self.posted, self.polls = {}, [], 0
        self.lock = threading.Lock()

    @property
    def endpoint(self):
        return "http://127.0.0.1:%d/sapi/v2/" % self.server_address[1]

    def __enter__(self):
        threading.Thread(target=self.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_):
        self.shutdown()
        self.server_close()

    def submit(self, body):
        with self.lock:
            identifier = "loopback-%04d" % len(self.problems)
            status = {"id": identifier, "type": body["type"], "solver": body["solver"], "label": body.get("label", ""),
                      "status": "PENDING", "submitted_on": "2026-01-01T00:00:00.000000Z"}
            self.problems[identifier] = status
            self.posted.append(body)
        threading.Thread(target=self.work, args=(status, body), daemon=True).start()
        return dict(status)

    def work(self, status, body):
        try:
            result = {"status": "COMPLETED", "answer": self.solve(body), "solved_on": "2026-01-01T00:00:01.000000Z"}
        except Exception as error:  # what a solver says becomes the job's message
            result = {"status": "FAILED", "error_message": str(error)}
        with self.lock:
            status.update(result)


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def reply(self, status, kind, value):
        content = json.dumps(value).encode()
        self.send_response(status)
        self.send_header("Content-Type", MEDIA % kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def refused(self, status, message):
        self.reply(status, "error", {"error_code": status, "error_msg": message})

    def allowed(self):
        if self.headers.get("X-Auth-Token") == self.server.token:
            return True
        self.refused(401, "Invalid token")
        return False

    def do_GET(self):
        url = urlsplit(self.path)
        path = url.path.split("/sapi/v2/", 1)[-1].strip("/")
        if not self.allowed():
            return None
        if path == "solvers/remote":
            return self.reply(200, "solver-definition-list", [self.server.solver])
        if path.startswith("solvers/remote/"):
            return self.reply(200, "solver-definition", self.server.solver)
        with self.server.lock:
            known = {key: dict(value) for key, value in self.server.problems.items()}
            self.server.polls += 1
        if path == "problems":
            wanted = parse_qs(url.query).get("id", [""])[0].split(",")
            brief = [{k: v for k, v in known[i].items() if k != "answer"} for i in wanted if i in known]
            return self.reply(200, "problems", brief)
        found = re.fullmatch(r"problems/([\w-]+)", path)
        if found and found.group(1) in known:
            return self.reply(200, "problem", known[found.group(1)])
        return self.refused(404, "no such thing here: " + path)

    def do_POST(self):
        content = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if not self.allowed():
            return None
        if self.headers.get("Content-Encoding") == "deflate":
            content = zlib.decompress(content)
        if urlsplit(self.path).path.rstrip("/").rsplit("/", 1)[-1] != "problems":
            return self.refused(404, "only problems can be posted here")
        return self.reply(200, "problems", [self.server.submit(body) for body in json.loads(content)])
