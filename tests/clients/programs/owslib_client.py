"""OWSLib: a client of OGC API - Processes that knows nothing of us."""

import json
import sys
import time

from owslib.ogcapi.processes import Processes

url, inputs = sys.argv[1], json.loads(sys.argv[2])
client = Processes(url)
description = client.api()
job = client.execute("benchmark", inputs=inputs, async_=True)["jobID"]
while (status := client._request(path=f"jobs/{job}")["status"]) in ("accepted", "running"):
    time.sleep(0.2)
rows = client._request(path=f"jobs/{job}/results")["outputs"]["rows"]
print(f"OpenAPI {description['openapi']}, {status}, {[row['code'] for row in rows]}")
