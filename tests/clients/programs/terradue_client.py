"""ogc-api-processes-client: Terradue's client, generated from the standard's own description."""

import json
import sys
import time

from ogc_api_processes_client.api.result_api import ResultApi
from ogc_api_processes_client.api_client_wrapper import ApiClientWrapper
from ogc_api_processes_client.configuration import Configuration

url, inputs = sys.argv[1], json.loads(sys.argv[2])
client = ApiClientWrapper(Configuration(host=url))
processes = client.get_processes().processes
headers = {"Content-Type": "application/json"}
job = client.execute_simple("benchmark", execute={"inputs": inputs}, _headers=headers).job_id
while (status := client.get_status(job_id=job).status.value) in ("accepted", "running"):
    time.sleep(0.2)
# Its models of results take neither integers nor lists of objects, so the bytes are read.
results = json.loads(ResultApi(client.api_client).get_result_without_preload_content(job_id=job).data)
print(f"{len(processes)} processes, {status}, {[row['code'] for row in results['rows']]}")
