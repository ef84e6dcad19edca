#!/usr/bin/env python3
"""What some addresses can do to another that asks ecoserve for something, measured:
attacks.py PORT SCENE PID FIGURES.json [LEAKS [SECONDS]]

One attacker comes from 127.0.0.2, crowds from 127.1.x.y, honest clients from 127.0.0.3, and from 127.2.x.y where each holds nothing; ecoserve
runs with its defaults. Prints a line an attack, ends with 1 if one succeeded: memory that grows by more than 1 % over LEAKS requests that the
library would drop (100,000), honest plans whose 99th percentile is more than three times that without an attack, honest probes of which less
than 99 % are answered within 1 s, requests that fail while packs are reloaded. Against crowds of several addresses, for SECONDS each (60), every
honest plan and every /healthz must be answered."""
import concurrent.futures
import json
import os
import random
import resource
import signal
import socket
import sys
import threading
import time

PORT, SCENE, PID, FIGURES = int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4]
LEAKS = int(sys.argv[5]) if len(sys.argv) > 5 else 100000
SECONDS = int(sys.argv[6]) if len(sys.argv) > 6 else 60
ATTACKER, HONEST = "127.0.0.2", "127.0.0.3"
failed = False
figures = {}


def connect(source):
    s = socket.socket()
    s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    s.bind((source, 0))
    s.settimeout(30)
    s.connect(("127.0.0.1", PORT))
    return s


def receive(s):
    """Status and length of one answer."""
    data = b""
    while b"\r\n\r\n" not in data:
        part = s.recv(65536)
        if not part:
            raise OSError("closed before an answer")
        data += part
    head, body = data.split(b"\r\n\r\n", 1)
    if head.startswith(b"HTTP/1.1 102"):
        return receive(s) if not body else (int(body[9:12]), len(body))
    length = next((int(line.split(b":")[1]) for line in head.split(b"\r\n") if line.lower().startswith(b"content-length:")), 0)
    while len(body) < length:
        part = s.recv(65536)
        if not part:
            raise OSError("closed within an answer")
        body += part
    return int(head[9:12]), length


def ask(source, target, method="GET", headers="", body=b""):
    """Status and seconds; 0: no answer."""
    begun = time.monotonic()
    try:
        with connect(source) as s:
            s.sendall(f"{method} {target} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}\r\n".encode() + body)
            return receive(s)[0], time.monotonic() - begun
    except OSError:
        return 0, time.monotonic() - begun


def view(rng, bytes_=None):
    """Somewhere above the scene; seldom asked twice."""
    x, y, up = rng.uniform(-200, 200), rng.uniform(-200, 200), rng.uniform(2, 300)
    target = f"/v1/scenes/{SCENE}/stream?eye={x:.3f},{y:.3f},{up:.3f}&target={rng.uniform(-50, 50):.3f},{rng.uniform(-50, 50):.3f},0" \
        f"&width=800&height=600&vertices={rng.randrange(1000, 1000000)}"
    return target + (f"&bytes={bytes_}" if bytes_ else "")


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def resident():
    with open(f"/proc/{PID}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def tell(name, good, text, **values):
    global failed
    failed = failed or not good
    figures[name] = values
    print(f"{name}: {text}{'' if good else ': TOO MUCH'}", flush=True)


class Flood:
    """Calls work() in threads until it is left."""

    def __init__(self, count, work):
        self.stop = threading.Event()
        self.threads = [threading.Thread(target=self.run, args=(work, i), daemon=True) for i in range(count)]

    def run(self, work, number):
        while not self.stop.is_set():
            work(number, self.stop)

    def __enter__(self):
        for thread in self.threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self.stop.set()
        for thread in self.threads:
            thread.join(60)


def leak():
    kinds = [b"GET /healthz?" + b"&" * 300 + b" HTTP/1.1\r\nHost: t\r\n\r\n",
             b"GET /healthz HTTP/1.1\r\nHost: t\r\nCookie: " + b"a=b; " * 300 + b"\r\n\r\n"]

    def round_of(count):
        for i in range(count):
            with connect(f"127.0.0.{2 + i % 200}") as s:
                s.sendall(kinds[i % 2])
                receive(s)
    round_of(min(5000, LEAKS))
    before = resident()
    round_of(LEAKS)
    after = resident()
    tell("leak", after <= before * 1.01, f"{LEAKS} requests that the library would drop: {before} kB before, {after} kB after",
         requests=LEAKS, before_kb=before, after_kb=after)


def worst_views():
    rng = random.Random(1)
    timed = []
    for _ in range(60):
        target = view(rng, 300000 if rng.random() < .5 else None)
        timed.append((ask(ATTACKER, target)[1], target))
    worst = [target for _, target in sorted(timed, reverse=True)[:10]]

    def honest(seconds):
        times, answered = [], 0
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            status, took = ask(HONEST, view(rng))
            times.append(took)
            answered += status == 200
            time.sleep(.05)
        return times, answered

    def attack(number, stop):
        ask(ATTACKER, worst[number] + str(rng.randrange(10)))    # other vertices, or other bytes: not from the cache
        stop.wait(.9)
    alone, _ = honest(20)
    with Flood(10, attack):
        time.sleep(1)
        beside, answered = honest(20)
    p_alone, p_beside = quantile(alone, .99), quantile(beside, .99)
    tell("worst views", answered == len(beside) and p_beside <= 3 * p_alone,
         f"10 worst views a second: {answered} of {len(beside)} honest plans, p99 {p_beside * 1e3:.0f} ms; {p_alone * 1e3:.0f} ms alone",
         alone_p99_s=p_alone, beside_p99_s=p_beside, plans=len(beside), answered=answered)


def probes(name, target, method="GET", headers="", body=b""):
    times = []
    end = time.monotonic() + 30
    while time.monotonic() < end:
        status, took = ask(HONEST, target, method, headers, body)
        times.append(took if status == 200 else 1e9)
        time.sleep(.05)
    within = sum(took <= 1 for took in times) / len(times)
    tell(name, within >= .99, f"{within * 100:.1f} % of {len(times)} honest probes within 1 s", probes=len(times), within_1_s=within)


def drip(first):
    """Connections that send a byte a second."""
    def work(number, stop):
        try:
            with connect(ATTACKER) as s:
                for byte in first:
                    s.sendall(bytes([byte]))
                    if stop.wait(1):
                        return
        except OSError:
            stop.wait(.2)
    return work


def idle_bodies(number, stop):
    head = f"POST /v1/scenes/{SCENE}/stream?eye=0,0,9&target=9,9,0&width=64&height=64&vertices=9 HTTP/1.1\r\nHost: t\r\n" \
        "Content-Type: application/octet-stream\r\nContent-Length: 4194304\r\n\r\n"
    try:
        with connect(ATTACKER) as s:
            s.sendall(head.encode())
            s.settimeout(1)
            while not stop.is_set():
                try:
                    if not s.recv(4096):
                        return
                except socket.timeout:
                    pass
    except OSError:
        stop.wait(.2)


def measure(seconds, seed):
    """Plans of addresses that hold nothing, and /healthz of the machine itself: seconds each, and what failed. In a process of its own."""
    rng = random.Random(seed)
    plans, probes, failed_plans, failed_probes = [], [], 0, 0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        status, took = ask(f"127.2.{rng.randrange(256)}.{rng.randrange(1, 255)}", view(rng))
        plans.append(took)
        failed_plans += status != 200
        status, took = ask("127.0.0.1", "/healthz")
        probes.append(took)
        failed_probes += status != 200
        time.sleep(.02)
    return plans, probes, failed_plans, failed_probes


def crowd_address(number):
    return f"127.1.{number // 250}.{number % 250 + 1}"


class Sockets:
    """As many connections of as many addresses as it can keep: begin(socket) each, and tick(socket) every second."""

    def __init__(self, addresses, each, begin, tick):
        self.places = [crowd_address(i // each) for i in range(addresses * each)]
        self.begin, self.tick = begin, tick
        self.open = {}
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)

    def fill(self):
        for i, address in enumerate(self.places):
            if i in self.open or self.stop.is_set():
                continue
            try:
                s = connect(address)
                self.begin(s)
                s.setblocking(False)
                self.open[i] = s
            except OSError:
                pass

    def run(self):
        while not self.stop.is_set():
            self.fill()
            for i, s in list(self.open.items()):
                try:
                    self.tick(s)
                except BlockingIOError:
                    pass
                except OSError:
                    self.open.pop(i).close()
            self.stop.wait(1)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.stop.set()
        self.thread.join(60)
        for s in self.open.values():
            s.close()


def planners(addresses, each, views):
    """So many plans of so many addresses that wait at any time, seldom asked for twice. A refusal costs this machine a pause, not a loop."""
    def work(number, stop):
        status, _ = ask(crowd_address(number // each), views[random.randrange(len(views))] + str(random.randrange(1000)))
        if status != 200:
            stop.wait(.5)
    return Flood(addresses * each, work)


def begin_body(s):
    s.sendall(f"POST {small} HTTP/1.1\r\nHost: t\r\nContent-Type: application/octet-stream\r\nContent-Length: 4194304\r\n\r\n".encode())


def begin_answer(s):
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    target = view(random.Random()).replace("stream", "plan") + "0&explain=1"
    s.sendall(f"GET {target} HTTP/1.1\r\nHost: t\r\n\r\n".encode() * 20)


def drip_byte(s):
    s.sendall(b"\0")


def look_only(s):
    s.recv(1, socket.MSG_PEEK)


def crowds(pool):
    rng = random.Random(2)
    timed = []
    for _ in range(60):
        target = view(rng, 300000 if rng.random() < .5 else None)
        timed.append((ask(ATTACKER, target)[1], target))
    worst = [target for _, target in sorted(timed, reverse=True)[:10]]
    kinds = [("3 addresses of 32 plans", lambda: planners(3, 32, worst)), ("20 addresses of 5 plans", lambda: planners(20, 5, worst)),
             ("8 addresses of 128 dripping bodies", lambda: Sockets(8, 128, begin_body, drip_byte)),
             ("50 addresses of 21 dripping bodies", lambda: Sockets(50, 21, begin_body, drip_byte)),
             ("8 addresses of 30 answers that are not taken", lambda: Sockets(8, 30, begin_answer, look_only))]
    for seed, (name, flood) in enumerate(kinds):
        before = resident()
        times = pool.submit(measure, SECONDS // 2, 20 + seed).result()[0]
        with flood():
            time.sleep(5)
            plans, probes, failed_plans, failed_probes = pool.submit(measure, SECONDS, 10 + seed).result()
        time.sleep(5)
        alone = quantile(times + pool.submit(measure, SECONDS // 2, 30 + seed).result()[0], .99)
        p99, grown = quantile(plans, .99), max(0, resident() - before) // 1024
        tell(name, not failed_plans and not failed_probes and p99 <= 3 * alone and grown <= 512,
             f"{len(plans) - failed_plans} of {len(plans)} honest plans, p99 {p99 * 1e3:.0f} ms, alone {alone * 1e3:.0f} ms; "
             f"{len(probes) - failed_probes} of {len(probes)} /healthz, p99 {quantile(probes, .99) * 1e3:.0f} ms; {grown} MiB more memory",
             alone_p99_s=alone, p99_s=p99, plans=len(plans), plans_failed=failed_plans, probes=len(probes), probes_failed=failed_probes,
             memory_mib=grown)


def reloads():
    bad, asked = [0], [0]

    def work(number, stop):
        status, _ = ask(HONEST, view(random.Random()))
        asked[0] += 1
        bad[0] += status != 200
    with open(f"/proc/{PID}/cmdline") as file:
        pack = file.read().split("\0")[-2].split("=", 1)[-1]
    with Flood(4, work):
        for _ in range(100):
            os.utime(pack)
            os.kill(PID, signal.SIGHUP)
            time.sleep(.2)
    tell("reloads", bad[0] == 0, f"100 reloads: {bad[0]} of {asked[0]} requests failed", asked=asked[0], failed=bad[0])


small = f"/v1/scenes/{SCENE}/stream?eye=0,0,9&target=9,9,0&width=64&height=64&vertices=9"
resource.setrlimit(resource.RLIMIT_NOFILE, (resource.getrlimit(resource.RLIMIT_NOFILE)[1],) * 2)
with concurrent.futures.ProcessPoolExecutor(1) as others:
    others.submit(quantile, [0], .5).result()   # before there are threads
    leak()
    worst_views()
    crowds(others)
with Flood(300, drip(b"GET /healthz HTTP/1.1\r\nX: " + b"a" * 200)):
    time.sleep(3)
    probes("slow heads", "/healthz")
with Flood(64, idle_bodies):
    time.sleep(2)
    probes("bodies", small, "POST", "Content-Type: application/octet-stream\r\nContent-Length: 4\r\n", b"\0\0\0\0")
reloads()
with open(FIGURES, "w") as out:
    json.dump(figures, out, indent=1)
sys.exit(failed)
