#!/bin/sh
# Build the image fprc:latest of the Containerfile.
# BASE=...: another image with Debian and Python 3.11 to 3.13. Docker counts only if its daemon answers.
set -eu
cd "${0%/*}/.."
for engine in podman docker buildah; do
  if "$engine" info >/dev/null 2>&1; then
    echo "container: building fprc:latest with $engine"
    exec "$engine" build --file Containerfile --tag fprc ${BASE:+--build-arg BASE="$BASE"} .
  fi
done
echo "container: no podman, docker or buildah that answers; install one, or start docker" >&2
exit 1
