#!/bin/bash
# A program of one rank that is started without mpirun, as small jobs are, makes a file for memory that ranks share, and a
# session folder. Open MPI 5.0.7 leaves both when such a program ends as it should: the file of 16 MiB (72 kB in use) is in
# /dev/shm unless told otherwise, where thousands of short runs fill a machine's memory. Open MPI 4.1.4 left nothing.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# Open MPI and Python of Debian 13, unpacked, not installed
mkdir -p lists/partial debs/partial root memory session && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' | sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror trixie main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$tmp/lists"
     -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp" -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=5.0.7-1
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install libopenmpi40=$version python3; } >apt.log 2>&1 ||
  { echo "Debian's libopenmpi40 $version cannot be had" >&2; exit 77; }
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done

cat >run.py <<'PYTHON'
import ctypes
mpi = ctypes.CDLL("libmpi.so.40", ctypes.RTLD_GLOBAL)
mpi.MPI_Init(None, None)
text, length = ctypes.create_string_buffer(256), ctypes.c_int()
mpi.MPI_Get_library_version(text, ctypes.byref(length))
mpi.MPI_Finalize()
print(text.value.decode().split(",")[0])
PYTHON
usr=$tmp/root/usr lib=$tmp/root/usr/lib/x86_64-linux-gnu
software=$(PYTHONHOME=$usr OPAL_PREFIX=$usr TMPDIR=$tmp/session OMPI_MCA_btl=self,sm OMPI_MCA_btl_sm_backing_directory=$tmp/memory \
  "$lib/ld-linux-x86-64.so.2" --library-path "$lib" "$usr/bin/python3.13" run.py 2>run.log) || { cat run.log >&2; exit 1; }
seen="files of 16 MiB: $(find memory -size 16M | wc -l), folders: $(find session -mindepth 1 -maxdepth 1 | wc -l)"

echo "software:     $software, libopenmpi40 $version of Debian 13"
echo "a good guess: files of 16 MiB: 0, folders: 0"
echo "seen:         $seen"
[[ $seen == "files of 16 MiB: 1, folders: 1" ]] || { echo CHANGED >&2; exit 1; }
