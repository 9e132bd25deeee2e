#!/usr/bin/env bash
# Builds contact3d-mpi. Where something of the system is missing, it stops before Cargo does and names the packages. With --check it builds
# nothing.
set -euo pipefail
shopt -s nullglob
missing=()
"${MPICC:-mpicc}" -show > /dev/null 2>&1 || missing+=("an MPI library with its compiler mpicc (libopenmpi-dev, openmpi-bin)")
places=("${LIBCLANG_PATH:-/usr/lib}" "$(llvm-config --libdir 2> /dev/null || true)" /usr/lib/llvm-*/lib /usr/lib* /usr/lib/* /usr/local/lib*)
libraries=()
for place in "${places[@]}"; do
  libraries+=("$place"/libclang.so* "$place"/libclang-[0-9]*.so*)
done
[ ${#libraries[@]} -gt 0 ] || missing+=("libclang, which reads the headers of the MPI library (libclang-dev)")
command -v clang > /dev/null || missing+=("the compiler clang, whose headers libclang takes (clang)")
if [ ${#missing[@]} -gt 0 ]; then
  echo "contact3d-mpi cannot be built here. Missing, with the packages of Debian and Ubuntu:" >&2
  printf '  %s\n' "${missing[@]}" >&2
  echo "apt-get install libopenmpi-dev openmpi-bin libclang-dev clang" >&2
  exit 1
fi
if [ "${1:-}" != --check ]; then
  cd "${BASH_SOURCE[0]%/*}/../.."
  cargo build --release --locked -p problems-mpi
fi
