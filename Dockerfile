# docker build -t doublet .
# docker run --rm -v "$PWD:/work" doublet reconstruct MY_SESSION -o out/mine
# scripts/try-dockerfile.py goes through these steps in a chroot, where there is no container runtime.
FROM debian:12 AS build
WORKDIR /src
COPY scripts/apt-install.sh scripts/apt-packages.txt scripts/
RUN scripts/apt-install.sh scripts/apt-packages.txt
COPY . .
RUN python3 -m venv /venv && /venv/bin/pip install -q build && /venv/bin/python -m build -q --wheel --outdir /wheels .

FROM debian:12
WORKDIR /setup
COPY scripts/apt-install.sh scripts/apt-packages-runtime.txt ./
RUN ./apt-install.sh apt-packages-runtime.txt && apt-get install -q -y --no-install-recommends python3-venv && rm -rf /var/lib/apt/lists/*
COPY --from=build /wheels /wheels
RUN python3 -m venv /opt/doublet && /opt/doublet/bin/pip install -q --no-cache-dir /wheels/*.whl && rm -r /wheels
ENV PATH=/opt/doublet/bin:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
WORKDIR /work
ENTRYPOINT ["doublet"]
