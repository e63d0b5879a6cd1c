"""Many operating points on a Dask cluster: each process is a pure function of its inputs, so any worker may run it.

`python examples/dask_cluster.py` starts two workers here; with the address of a scheduler, such as
tls://scheduler:8786, it uses that cluster, on whose workers safestart is installed.
"""

import sys

from dask.distributed import Client, LocalCluster


def share(rate: float) -> float:
    """Certified share of the corridor at a tumble rate, deg/s."""
    import safestart as ss

    grid = {"nx": 41, "ny": 41, "y_max_m": 150}
    found = ss.run("coverage", {"omega_t_deg_s": [rate], "a_max_m_s2": [0.1], "grid": grid}, progress=False)
    return found.tables()["cells"][0]["safe_percent"]


def main(address: str | None) -> None:
    """Ask for four rates and print them in their order."""
    rates = [1.0, 2.0, 3.0, 5.0]
    made = None if address else LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with Client(address or made) as client:
        shares = client.gather(client.map(share, rates, pure=True))
    if made is not None:
        made.close()
    for rate, found in zip(rates, shares, strict=True):
        print(f"{rate:g} deg/s: {found:.1f} % certified")
    assert shares == sorted(shares, reverse=True)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
