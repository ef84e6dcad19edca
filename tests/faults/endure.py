#!/usr/bin/env python3
"""Whether ecoserve's memory grows with what it answers: endure.py PORT SCENE PID CHUNKS [REQUESTS [WARM]]

After WARM requests (50,000) and until its kept answers have filled their room, REQUESTS (a million) of all kinds, over connections that
last for a hundred: plans and streams of ever other views, kept answers, tags that match, chunks whole and in part, holdings, the small
routes, and what is refused. Ends with 1 if an answer has another status than it should, or memory is 2 % above what it was when warm."""
import random
import re
import socket
import sys

PORT, SCENE, PID, CHUNKS = int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4]
REQUESTS = int(sys.argv[5]) if len(sys.argv) > 5 else 1000000
WARM = int(sys.argv[6]) if len(sys.argv) > 6 else 50000
TOGETHER = 100           # requests of a connection, sent at once
DEAR = 50                # one in so many makes a plan
rng = random.Random(21)
base = f"/v1/scenes/{SCENE}"


def connection():
    s = socket.create_connection(("127.0.0.1", PORT), timeout=120)
    return s, s.makefile("rb", 1 << 20)


def read(file):
    """Status, headers and body of one answer."""
    status = 102
    while status == 102:
        line = file.readline()
        if not line:
            raise OSError("closed before an answer")
        status, headers = int(line[9:12]), {}
        while (line := file.readline()) not in (b"\r\n", b""):
            name, value = line.split(b":", 1)
            headers[name.lower()] = value.strip()
    return status, headers, b"" if status == 304 else file.read(int(headers.get(b"content-length", 0)))


def ask(target, headers=""):
    s, file = connection()
    with s, file:
        s.sendall(f"GET {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}\r\n".encode())
        return read(file)


def new_view():
    return f"eye={rng.uniform(-200, 200):.3f},{rng.uniform(-200, 200):.3f},{rng.uniform(2, 300):.3f}&target=0,0,0" \
        f"&width=320&height=240&vertices={rng.randrange(100, 20000)}"


def get(target, status, headers=""):
    return f"GET {target} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n".encode(), status


def post(target, body, status):
    headers = f"Content-Type: application/octet-stream\r\nContent-Length: {len(body)}\r\n"
    return f"POST {target} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n".encode() + body, status


kept = f"{base}/stream?{new_view()}"
status, headers, _ = ask(kept)
assert status == 200, f"{kept}: {status}"
tag = headers[b"etag"].decode()
chunks = [f"{base}/chunks/{name}" for name in sorted(open(CHUNKS).read().split())]
CHEAP = [lambda: get(kept, 200), lambda: get(kept, 304, f"If-None-Match: {tag}\r\n"), lambda: get(rng.choice(chunks), 200),
    lambda: get(rng.choice(chunks), 206, "Range: bytes=0-9\r\n"), lambda: get("/healthz", 200), lambda: get("/readyz", 200),
    lambda: get(base, 200), lambda: get(f"{base}/stream?eye=1", 400), lambda: get(f"{base}/chunks/{rng.getrandbits(128):032x}", 404),
    lambda: get(f"/v1/scenes/x{rng.getrandbits(64)}", 404), lambda: post(f"{base}/stream?{new_view()}", b"\xff" * 40, 400)]
DEARER = [lambda: get(f"{base}/stream?{new_view()}", 200), lambda: get(f"{base}/plan?{new_view()}", 200),
    lambda: post(f"{base}/stream?{new_view()}", bytes(4), 200), lambda: get("/metrics", 200), lambda: get("/v1/scenes", 200)]


def some_answers():
    """A connection's: every one as it should be."""
    asked = [rng.choice(DEARER if rng.randrange(DEAR) == 0 else CHEAP)() for _ in range(TOGETHER)]
    s, file = connection()
    with s, file:
        s.sendall(b"".join(request for request, _ in asked))
        for request, wanted in asked:
            status = read(file)[0]
            if status != wanted:
                sys.exit(f"endure: {request[:200]}: {status}, not {wanted}")


def resident():
    with open(f"/proc/{PID}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def kept_bytes():
    text = ask("/metrics")[2].decode()
    found = re.search(r"^ecoserve_kept_bytes\S* (\d+)", text, re.M)
    return int(found[1]) if found else 0


for _ in range(WARM // TOGETHER):
    some_answers()
full = -1
while kept_bytes() > full:                       # a cache that still grows is not full
    full = kept_bytes()
    for _ in range(100):
        some_answers()
before = resident()
for i in range(REQUESTS // TOGETHER):
    some_answers()
    if i % (REQUESTS // TOGETHER // 10) == 0:
        print(f"endure: {i * TOGETHER} requests, {resident()} kB", flush=True)
after = resident()
print(f"endure: {REQUESTS} requests of all kinds, {len(chunks)} chunks: {before} kB before, {after} kB after: "
      f"{100 * (after - before) / before:+.2f} %")
sys.exit(after > 1.02 * before)
