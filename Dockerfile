# gonogo in a container, from the same two steps as on a machine: scripts/setup.sh and the build.
#
#   docker build -t gonogo --build-arg GONOGO_REVISION="$(git describe --always --dirty --abbrev=12 --exclude='*')" .
#   docker run --rm -v "$PWD/out:/work/out" gonogo run /opt/gonogo/configs/studies/demo.json --out out/demo
#
# With the CUDA backend; running it needs the NVIDIA container toolkit:
#
#   docker build -t gonogo:cuda --build-arg BASE=nvidia/cuda:13.0.1-devel-ubuntu24.04 --build-arg PRESET=cuda-release .
#   docker run --rm --gpus all gonogo:cuda doctor
ARG BASE=debian:12
FROM ${BASE}
WORKDIR /opt/gonogo

# Packages first: they are installed anew only when these two scripts change.
COPY scripts/setup.sh scripts/common.sh scripts/
RUN scripts/setup.sh && rm -rf /var/lib/apt/lists/*

COPY . .
ARG PRESET=cpu-release
ARG GONOGO_REVISION=unknown
# Bash by name: images in OCI format, as buildah and podman make them, keep no SHELL.
RUN ["/bin/bash", "-euo", "pipefail", "-c", "source scripts/common.sh; configure $PRESET -DGONOGO_TESTS=OFF; build $PRESET gonogo; \
    ln -s /opt/gonogo/build/$PRESET/gonogo /usr/local/bin/gonogo; gonogo doctor"]

WORKDIR /work
ENTRYPOINT ["gonogo"]
CMD ["--help"]
