#!/bin/bash
# pair granular: "damping coeff_restitution" takes the coefficient of restitution that a contact shall have, and has it: 0.2
# of 0.2. With limit_damping, which keeps balls from pulling at each other while they part, and which one adds as such a
# pull is not physical, the same coefficient gives 0.325: the dashpot is still that of a contact which pulls. Cundall's
# formula for the time of loading alone, exp(-2 z/s atan(s/z)) with s = sqrt(1 - z^2), gives this number, by the ratio of damping z.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund lammps.js@1.5.1 >npm.log 2>&1 || { echo "lammps.js 1.5.1 cannot be had" >&2; exit 77; }

cat >run.mjs <<'JS'
import make from 'lammps.js/wasm-atomify';
const lmp = await make({ print: line => { if (/^LAMMPS|^restitution/.test(line)) console.log(line); } });
for (const limit of ['', 'limit_damping']) {
  const one = new lmp.LAMMPSWeb();
  one.startWithArgs([]);
  one.runScript(`units si
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -4 4 -2 2 -2 2
create_box 1 box
create_atoms 1 single -0.5 0 0
create_atoms 1 single 0.5001 0 0
set type 1 diameter 1 density 2000
set atom 1 vx 1
pair_style granular
pair_coeff * * hooke 1e7 0.2 tangential linear_nohistory 0 0 damping coeff_restitution ${limit}
fix 1 all nve/sphere
timestep 1e-6
thermo 100000
run 100000
print "restitution $(vx[2]-vx[1]:%.3f) ${limit}"`);
}
process.exit(0);
JS
seen=$(node run.mjs 2>node.log | sort -u | xargs)
z=$(awk 'BEGIN { l = log(0.2); printf "%.12f", -l / sqrt(3.14159265358979 ^ 2 + l ^ 2) }')
formula=$(awk -v z="$z" 'BEGIN { s = sqrt(1 - z * z); printf "%.3f", exp(-2 * z / s * atan2(s, z)) }')
expected="LAMMPS (10 Sep 2025) restitution 0.200 restitution 0.325 limit_damping"

echo "software:     LAMMPS of lammps.js 1.5.1"
echo "a good guess: 0.2 with and without limit_damping"
echo "seen:         $seen (formula: $formula)"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
