// The types that openapi-typescript made of our OpenAPI 3.1 description, with its companion openapi-fetch.
import createClient from "openapi-fetch";
import type { components, paths } from "./safestart.js";

const [url, text] = process.argv.slice(2);
const inputs: components["schemas"]["BenchmarkInputs"] = JSON.parse(text!);
const client = createClient<paths>({ baseUrl: url! });
const { data: made } = await client.POST("/processes/{processID}/execution", {
  params: { path: { processID: "benchmark" } },
  body: { inputs } as components["schemas"]["ExecuteBenchmark"],
});
const { jobID } = made as components["schemas"]["Submitted"];
let status: components["schemas"]["JobStatus"];
do {
  const { data } = await client.GET("/jobs/{jobID}", { params: { path: { jobID }, query: { wait: 5 } } });
  status = data!.status;
} while (status === "accepted" || status === "running");
const { data: result } = await client.GET("/jobs/{jobID}/results", { params: { path: { jobID } } });
const rows = (result as components["schemas"]["ResultDocument"]).outputs["rows"] as { code: string }[];
console.log(`${status}, ${JSON.stringify(rows.map((row) => row.code))}`);
