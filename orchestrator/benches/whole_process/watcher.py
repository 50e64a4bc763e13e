"""Subscribes to all runs that listen at an endpoint, one after the other; prints the name of each.

    watcher.py ENDPOINT
"""

import json
import sys

import zenoh

retry = {"period_init_ms": 5, "period_max_ms": 5, "period_increase_factor": 1}
connect = {"endpoints": [sys.argv[1]], "timeout_ms": -1, "retry": retry}
with zenoh.open(zenoh.Config.from_json5(json.dumps({"mode": "client", "connect": connect}))) as session:
    subscriber = session.declare_subscriber("lockstep/**")
    last = None
    for sample in subscriber:
        run = json.loads(sample.payload.to_string())["run"]
        if run != last:
            print(run, flush=True)
        last = run
