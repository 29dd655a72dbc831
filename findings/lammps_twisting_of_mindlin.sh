#!/bin/bash
# pair granular, twisting marshall: the stiffness against twisting is half of the tangential one times the square of the
# contact's radius a. With tangential mindlin the coefficient is a pressure, and the tangential stiffness is the coefficient
# times a. LAMMPS of September 2021 includes this a; that of September 2025 does not: the same deck, without a word, is 1/a
# times as stiff (14 times here), and its result depends on the unit of length. Here a ball is held at its overlap and
# twists freely on a fixed one, whose period gives the stiffness.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
skip() { echo "$1 cannot be had here" >&2; exit 77; }
npm install --silent --no-audit --no-fund lammps.js@1.5.1 >npm.log 2>&1 || skip "lammps.js 1.5.1"

# LAMMPS of Debian 12 with the libraries that it needs, unpacked, not installed
mkdir -p lists/partial debs/partial root && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' | sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$tmp/lists"
     -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp" -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=20220106.git7586adbb6a+ds1-2+b2
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install lammps=$version; } >apt.log 2>&1 ||
  skip "Debian's lammps $version"
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done

cat >in.twist <<'DECK'
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region box block -2 2 -2 2 -2 2
create_box 2 box
create_atoms 1 single 0 0 0.49
create_atoms 2 single 0 0 -0.49
set type 1*2 diameter 1 density 2000
set type 1 omega 0 0 0.001
group ball type 1
pair_style granular
pair_coeff * * hertz/material 1e7 0 0.3 tangential mindlin 1e7 0 0.4 twisting marshall
fix 1 ball setforce 0 0 0
fix 2 ball nve/sphere
timestep 1e-5
compute w ball property/atom omegaz
compute spin ball reduce sum c_w
thermo_style custom step c_spin
run 10000
print "k = $((acos(c_spin/0.001)/0.1)^2*0.1*2000*PI/6:%.0f) N m"
DECK
echo "import make from 'lammps.js/wasm-atomify'; import fs from 'fs'; const lmp = new (await make({ print: console.log })).LAMMPSWeb();
lmp.startWithArgs([]); lmp.runScript(fs.readFileSync('in.twist', 'utf8')); process.exit(0);" >run.mjs
lib=$tmp/root/usr/lib/x86_64-linux-gnu
old=$(env OPAL_PREFIX="$tmp/root/usr" OMPI_MCA_btl=self OMPI_MCA_ess_singleton_isolated=1 root/lib/x86_64-linux-gnu/ld-linux-x86-64.so.2 --library-path \
  "$lib:$tmp/root/lib/x86_64-linux-gnu:$lib/blas:$lib/lapack" root/usr/bin/lmp -in in.twist -log none 2>&1 | grep -E '^LAMMPS|^k =' | xargs)
new=$(node run.mjs 2>&1 | grep -E '^LAMMPS|^k =' | xargs)
echo "software:     LAMMPS of Debian 12 and of lammps.js 1.5.1"
echo "a good guess: the same stiffness in both: 0.5 (1e7 Pa a) a^2 = 1768 N m, a = sqrt(0.25 m 0.02 m)"
echo "seen:         $old; $new"
[[ $old == "LAMMPS (29 Sep 2021 - Update 2) k = 1768 N m" && $new == "LAMMPS (10 Sep 2025) k = 25000 N m" ]] || { echo CHANGED >&2; exit 1; }
