# The worker with every engine; the same image runs the Dask scheduler and the Dask workers.
FROM python:3.13-slim-trixie AS build
RUN pip install --no-cache-dir uv==0.13.9
WORKDIR /src
COPY pyproject.toml ./
COPY core core
COPY service service
COPY worker worker
ENV UV_PROJECT_ENVIRONMENT=/opt/safestart UV_LINK_MODE=copy UV_COMPILE_BYTECODE=1
RUN uv sync --no-dev --no-editable --package safestart-worker

FROM python:3.13-slim-trixie
RUN useradd --system --uid 10001 --create-home safestart
COPY --from=build /opt/safestart /opt/safestart
# Without a place for compiled kernels the engines cannot even be imported: a volume, as the rest may be read-only, and
# filled here, so that the first job need not wait. On a processor of another kind they are compiled again.
RUN mkdir /var/cache/safestart && chown 10001 /var/cache/safestart
ENV PATH=/opt/safestart/bin:$PATH PYTHONUNBUFFERED=1 SAFESTART_LOG_FORMAT=json NUMBA_CACHE_DIR=/var/cache/safestart \
    MPLCONFIGDIR=/var/cache/safestart/matplotlib NUMBA_NUM_THREADS=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
USER 10001
RUN ["python", "-c", "from safestart.runtime.kernels.warmup import warm; warm()"]
VOLUME /var/cache/safestart
HEALTHCHECK --interval=30s --timeout=60s --start-period=300s --retries=3 \
    CMD ["python", "-m", "safestart_worker.health"]
ENTRYPOINT []
CMD ["safestart", "worker"]
