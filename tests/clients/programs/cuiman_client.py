"""cuiman: the client of Eozilla for OGC API - Processes."""

import json
import sys
import time

from cuiman import Client
from gavicore.models import ProcessRequest

url, inputs = sys.argv[1], json.loads(sys.argv[2])
client = Client(api_url=url)
processes = client.get_processes().processes
job = client.execute_process("benchmark", ProcessRequest(inputs=inputs)).jobID
while (status := client.get_job(job).status.value) in ("accepted", "running"):
    time.sleep(0.2)
results = client.get_job_results(job)
rows = results.root["outputs"]["rows"]
print(f"{len(processes)} processes, {status}, {[row['code'] for row in rows]}")
