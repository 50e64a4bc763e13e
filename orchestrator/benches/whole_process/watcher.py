"""Watches whatever run listens at an endpoint, again and again; prints the name of each run that it sees.

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
    for said in subscriber:
        run = json.loads(said.payload.to_string())["run"]
        if run != last:
            print(run, flush=True)
        last = run
